#include "services/tensor_voting/worker/point_tiles.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "common/tiles/vector_memory.hpp"

namespace curbstone::tensor_voting::worker {

bool PointTiles::plausible(const map_points_t& m) const {
  if (std::abs(static_cast<double>(m.tile_x)) > limits_.key || std::abs(static_cast<double>(m.tile_y)) > limits_.key) {
    return false;
  }
  if (m.first < 0 || m.num_points < 0) return false;
  if (!(std::abs(m.z_origin) <= 100'000) || m.z_origin != std::round(m.z_origin)) return false;
  const auto inside = [](std::int16_t v) { return v >= 0 && v < kStepsPerTile; };
  const auto inside_or_removal = [&](std::int16_t v) { return inside(v) || inside(static_cast<std::int16_t>(-1 - v)); };
  return std::all_of(m.x.begin(), m.x.end(), inside_or_removal) && std::all_of(m.y.begin(), m.y.end(), inside);
}

/// Counts a removal for each of the nine tiles that votes of the point may have reached.
void PointTiles::count_removal(PointTile& tile, const TilePoint& point) const {
  for (int i = 0; i < 9; ++i) {
    const auto reaches = [&](int towards, int along) {
      return towards == 0 || (towards < 0 ? along < limits_.reach : kStepsPerTile - along <= limits_.reach);
    };
    if (reaches(i % 3 - 1, point.x) && reaches(i / 3 - 1, point.y)) ++tile.removals[static_cast<std::size_t>(i)];
  }
}

/// Whether the message brings new records that fit: kAdded, else why not. `tile`: what is known of it, or nullptr.
PointTiles::Outcome PointTiles::judge(const map_points_t& message, const PointTile* tile) const {
  if (!plausible(message)) return Outcome::kRefused;
  if (tile != nullptr && tile->z_origin != static_cast<std::int32_t>(message.z_origin)) return Outcome::kRefused;
  const std::size_t have = tile == nullptr ? 0 : static_cast<std::size_t>(tile->records);
  const auto first = static_cast<std::size_t>(message.first);
  const auto count = static_cast<std::size_t>(message.num_points);
  if (first > have) return Outcome::kGap;
  if (first + count <= have) return Outcome::kDuplicate;
  const auto added = std::count_if(message.x.begin() + static_cast<std::ptrdiff_t>(have - first), message.x.end(),
                                   [](std::int16_t x) { return x >= 0; });
  const bool is_full = (added > 0 && num_points_ + static_cast<std::size_t>(added) > limits_.points) ||
                       first + count > limits_.points_per_tile;
  return is_full ? Outcome::kFull : Outcome::kAdded;
}

/// Appends the records of the message from `begin` on. False if a removal names a point that the tile does not have.
bool PointTiles::append(const map_points_t& message, std::size_t begin, PointTile& tile) const {
  const auto count = static_cast<std::size_t>(message.num_points);
  make_room(count - begin, tile.points);
  for (std::size_t i = begin; i < count; ++i) {
    const TilePoint record{message.x[i], message.y[i], message.z[i], message.intensity[i]};
    ++tile.records;
    if (!is_removal(record)) {
      tile.points.push_back(record);
      continue;
    }
    const TilePoint point = removal_of(record);
    const auto at = std::find_if(tile.points.begin(), tile.points.end(),
                                 [&](const TilePoint& p) { return at_one_place(p, point); });
    if (at == tile.points.end()) return false;
    tile.points.erase(at);
    count_removal(tile, point);
  }
  return true;
}

PointTiles::Taken PointTiles::take(const map_points_t& message) {
  const TileKey key{message.tile_x, message.tile_y};
  if (const Outcome outcome = judge(message, find(key)); outcome != Outcome::kAdded) return {outcome, {}};

  PointTile& tile = tiles_[key];
  PointTile before;
  const bool removes = std::any_of(message.x.begin(), message.x.end(), [](std::int16_t x) { return x < 0; });
  if (removes) before = tile;
  const std::size_t num_before = tile.points.size();
  const auto known = static_cast<std::size_t>(tile.records - message.first);  // records of the message
  tile.z_origin = static_cast<std::int32_t>(message.z_origin);
  tile.utime = std::max(tile.utime, message.utime);
  if (!append(message, known, tile)) {
    tile = before;
    if (before.records == 0) tiles_.erase(key);
    return {Outcome::kRefused, {}};
  }
  num_points_ += tile.points.size();
  num_points_ -= num_before;
  if (removes) return {Outcome::kAdded, {}, true};
  return {Outcome::kAdded, std::span(tile.points).subspan(num_before)};
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

}  // namespace curbstone::tensor_voting::worker
