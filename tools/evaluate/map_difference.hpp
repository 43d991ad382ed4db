#pragma once

#include <string>
#include <vector>

#include "services/semantic_map/tile/map_types.hpp"

namespace curbstone::evaluate {

/// The content of a map file.
struct StoredMap {
  std::vector<semantic_map::tile::MapTile> tiles;              ///< by key
  std::vector<semantic_map::tile::CurbLine> curbs;             ///< by id
  std::vector<semantic_map::tile::TrajectoryPose> trajectory;  ///< by utime
};

/// The difference of two maps of one drive, such as the live one and its replay. There is none if no message was lost.
struct MapDifference {
  int tiles = 0;           ///< in either
  int tiles_differ = 0;    ///< in any field, or present in one map only
  int classes_differ = 0;  ///< cells of a different class
  int poses = 0;           ///< in either
  int poses_differ = 0;    ///< by a bit, or present in one map only
  double largest_m = 0;    ///< between poses of the same time
  bool curbs_differ = false;

  [[nodiscard]] bool none() const { return tiles_differ == 0 && poses_differ == 0 && !curbs_differ; }
};
[[nodiscard]] MapDifference difference(const StoredMap& a, const StoredMap& b);

/// One line for people.
[[nodiscard]] std::string to_line(const MapDifference& difference);

}  // namespace curbstone::evaluate
