#include "services/tensor_voting/point_tiles.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace curbstone {

bool PointTiles::plausible(const map_points_t& m) const {
  if (std::abs(static_cast<double>(m.tile_x)) > limits_.key || std::abs(static_cast<double>(m.tile_y)) > limits_.key) {
    return false;
  }
  if (m.first < 0 || m.num_points < 0) return false;
  if (!(std::abs(m.z_origin) <= 100'000) || m.z_origin != std::round(m.z_origin)) return false;
  const auto inside = [](std::int16_t v) { return v >= 0 && v < kStepsPerTile; };
  return std::all_of(m.x.begin(), m.x.end(), inside) && std::all_of(m.y.begin(), m.y.end(), inside);
}

PointTiles::Taken PointTiles::take(const map_points_t& message) {
  if (!plausible(message)) return {Outcome::kRefused, {}};
  const TileKey key{message.tile_x, message.tile_y};
  const auto it = tiles_.find(key);
  const std::size_t have = it == tiles_.end() ? 0 : it->second.points.size();
  const auto first = static_cast<std::size_t>(message.first);
  const auto count = static_cast<std::size_t>(message.num_points);
  if (it != tiles_.end() && it->second.z_origin != static_cast<std::int32_t>(message.z_origin)) {
    return {Outcome::kRefused, {}};
  }
  if (first > have) return {Outcome::kGap, {}};
  if (first + count <= have) return {Outcome::kDuplicate, {}};
  const std::size_t num_new = first + count - have;
  if (num_points_ + num_new > limits_.points || have + num_new > limits_.points_per_tile) return {Outcome::kFull, {}};

  PointTile& tile = tiles_[key];
  tile.z_origin = static_cast<std::int32_t>(message.z_origin);
  tile.utime = std::max(tile.utime, message.utime);
  for (std::size_t i = have - first; i < count; ++i) {
    tile.points.push_back({message.x[i], message.y[i], message.z[i], message.intensity[i]});
  }
  num_points_ += num_new;
  return {Outcome::kAdded, std::span(tile.points).subspan(have)};
}

void PointTiles::erase(TileKey key) {
  const auto it = tiles_.find(key);
  if (it == tiles_.end()) return;
  num_points_ -= it->second.points.size();
  tiles_.erase(it);
}

void PointTiles::clear() {
  tiles_.clear();
  num_points_ = 0;
}

const PointTile* PointTiles::find(TileKey key) const {
  const auto it = tiles_.find(key);
  return it == tiles_.end() ? nullptr : &it->second;
}

}  // namespace curbstone
