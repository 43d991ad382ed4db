#include "tools/evaluate/map_difference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace curbstone::evaluate {

MapDifference difference(const StoredMap& a, const StoredMap& b) {
  MapDifference out;
  std::map<TileKey, const semantic_map::tile::MapTile*> tiles;
  for (const semantic_map::tile::MapTile& tile : b.tiles) tiles.emplace(tile.key, &tile);
  const semantic_map::tile::MapTile empty;
  const auto compare = [&](const semantic_map::tile::MapTile& one, const semantic_map::tile::MapTile& other) {
    ++out.tiles;
    out.tiles_differ += one == other ? 0 : 1;
    for (std::size_t i = 0; i < one.cell_class.size(); ++i)
      out.classes_differ += one.cell_class[i] == other.cell_class[i] ? 0 : 1;
  };
  for (const semantic_map::tile::MapTile& tile : a.tiles) {
    const auto there = tiles.find(tile.key);
    compare(tile, there == tiles.end() ? empty : *there->second);
    if (there != tiles.end()) tiles.erase(there);
  }
  for (const auto& [key, tile] : tiles) compare(*tile, empty);

  std::map<std::int64_t, const semantic_map::tile::TrajectoryPose*> poses;
  for (const semantic_map::tile::TrajectoryPose& pose : b.trajectory) poses.emplace(pose.utime, &pose);
  for (const semantic_map::tile::TrajectoryPose& pose : a.trajectory) {
    ++out.poses;
    const auto there = poses.find(pose.utime);
    if (there == poses.end()) {
      ++out.poses_differ;
      continue;
    }
    const Pose& other = there->second->T_map_base;
    out.poses_differ += pose.T_map_base.matrix() == other.matrix() ? 0 : 1;
    out.largest_m = std::max(out.largest_m, (pose.T_map_base.translation() - other.translation()).norm());
    poses.erase(there);
  }
  out.poses += static_cast<int>(poses.size());
  out.poses_differ += static_cast<int>(poses.size());
  out.curbs_differ = a.curbs != b.curbs;
  return out;
}

std::string to_line(const MapDifference& d) {
  if (d.none()) return fmt::format("the same, bit for bit: {} tiles, {} poses, and the curbs", d.tiles, d.poses);
  return fmt::format("{} of {} tiles differ ({} cells in class), {} of {} poses (by {:.3f} m at most), the curbs {}",
                     d.tiles_differ, d.tiles, d.classes_differ, d.poses_differ, d.poses, d.largest_m,
                     d.curbs_differ ? "too" : "not");
}

}  // namespace curbstone::evaluate
