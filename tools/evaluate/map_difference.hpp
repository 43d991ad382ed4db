#pragma once

#include <string>
#include <vector>

#include "services/semantic_map/tile/map_types.hpp"

namespace curbstone::evaluate {

/// What is in a map file.
struct StoredMap {
  std::vector<semantic_map::tile::MapTile> tiles;              ///< by key
  std::vector<semantic_map::tile::CurbLine> curbs;             ///< by id
  std::vector<semantic_map::tile::TrajectoryPose> trajectory;  ///< by utime
};

/// How two maps of one drive differ, the live one and its replay: in nothing, if nothing was lost on the way.
struct MapDifference {
  int tiles = 0;           ///< in either
  int tiles_differ = 0;    ///< in anything, or in one map only
  int classes_differ = 0;  ///< cells of another class
  int poses = 0;           ///< in either
  int poses_differ = 0;    ///< by a bit, or in one map only
  double largest_m = 0;    ///< between poses of the same time
  bool curbs_differ = false;

  [[nodiscard]] bool none() const { return tiles_differ == 0 && poses_differ == 0 && !curbs_differ; }
};
[[nodiscard]] MapDifference difference(const StoredMap& a, const StoredMap& b);

/// A line for people.
[[nodiscard]] std::string to_line(const MapDifference& difference);

}  // namespace curbstone::evaluate
