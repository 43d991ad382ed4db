#include "services/viewer/foxglove/near_points.hpp"

#include <algorithm>
#include <cmath>

namespace curbstone::viewer::foxglove {

bool NearPoints::put(const map_points_t& message) {
  const auto n = static_cast<std::size_t>(std::max(0, message.num_points));
  const bool is_sound = message.first >= 0 && std::isfinite(message.z_origin) && message.x.size() == n &&
                        message.y.size() == n && message.z.size() == n && message.intensity.size() == n;
  if (!is_sound) return false;
  if (message.epoch != epoch_ || n == 0) return true;
  const TileKey key{message.tile_x, message.tile_y};
  if (tiles_.size() >= kMaxTiles && !tiles_.contains(key)) return true;
  apply(message, tiles_[key]);
  utime_ = std::max(utime_, message.utime);
  ++number_;
  return true;
}

/// Skips the records that were received before.
void NearPoints::apply(const map_points_t& message, Tile& tile) {
  tile.z_origin = double{message.z_origin};
  const std::int64_t end = std::int64_t{message.first} + message.num_points;
  for (std::int64_t at = std::max<std::int64_t>(tile.next, message.first); at < end; ++at) {
    const auto i = static_cast<std::size_t>(at - message.first);
    const TilePoint record{message.x[i], message.y[i], message.z[i], message.intensity[i]};
    if (!is_removal(record)) {
      if (tile.points.size() < kMaxTilePoints) tile.points.push_back(record);
      continue;
    }
    const TilePoint gone = removal_of(record);
    const auto found = std::find_if(tile.points.begin(), tile.points.end(),
                                    [&](const TilePoint& point) { return at_one_place(point, gone); });
    if (found == tile.points.end()) continue;
    *found = tile.points.back();
    tile.points.pop_back();
  }
  tile.next = std::max(tile.next, end);
}

void NearPoints::look_from(std::int32_t epoch, double x, double y) {
  if (epoch != epoch_) {
    epoch_ = epoch;
    tiles_.clear();
    ++number_;
  }
  std::erase_if(tiles_, [&](const auto& entry) { return squared_distance(entry.first, x, y) > kReach * kReach; });
}

std::vector<CloudPoint> NearPoints::points() const {
  std::size_t all = 0;
  for (const auto& [key, tile] : tiles_) all += tile.points.size();
  const std::size_t stride = all / kMaxMessagePoints + 1;
  std::vector<CloudPoint> cloud;
  cloud.reserve(all / stride + 1);
  std::size_t count = 0;
  for (const auto& [key, tile] : tiles_) {
    for (const TilePoint& p : tile.points) {
      if (count++ % stride != 0) continue;
      cloud.push_back({static_cast<float>(key.x * kTileSize + p.x * kPositionStep),
                       static_cast<float>(key.y * kTileSize + p.y * kPositionStep),
                       static_cast<float>(tile.z_origin + p.z * kPositionStep), static_cast<float>(p.intensity)});
    }
  }
  return cloud;
}

}  // namespace curbstone::viewer::foxglove
