#pragma once

#include <string>
#include <vector>

#include "services/semantic_map/map_types.hpp"

namespace curbstone {

/// What is in a map file.
struct StoredMap {
  std::vector<MapTile> tiles;              ///< by key
  std::vector<CurbLine> curbs;             ///< by id
  std::vector<TrajectoryPose> trajectory;  ///< by utime
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

}  // namespace curbstone
