#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "services/semantic_map/tile/map_types.hpp"

namespace curbstone::localizer::test_yard {

/// A yard with the origin in it: four walls, not along the tiles' axes, two pillars, and a curb of 0.1 m across. Its
/// map as the semantic map would show it, and what a LiDAR in it would see.
struct Yard {
  double half_length = 11;  ///< m, along x of the yard
  double half_width = 7;    ///< m
  double turned = 0.3;      ///< rad, of the yard in map
  double curb = -3;         ///< m, y of the yard: higher beyond
  bool open = false;        ///< without its west end and the western half of its north: no other way round looks alike
  bool ends = true;         ///< false: two long walls only, and no pillars
};

[[nodiscard]] std::vector<semantic_map::tile::MapTile> map_of(const Yard& yard);
/// The tiles, and all of them once more, so many tiles on along x.
[[nodiscard]] std::vector<semantic_map::tile::MapTile> twice(std::vector<semantic_map::tile::MapTile> tiles, int on);
/// In base_link of a vehicle at T_map_base.
[[nodiscard]] std::vector<Eigen::Vector3d> points_in(const Yard& yard, const Pose& T_map_base);
[[nodiscard]] Pose pose_at(double x, double y, double yaw);

}  // namespace curbstone::localizer::test_yard
