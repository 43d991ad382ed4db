#pragma once

#include "tools/bench/curbs/scenes/curb_scene.hpp"
#include "tools/bench/curbs/scenes/drive_tiles.hpp"

namespace curbstone::bench::curbs::scenes {

/// A drive of the vehicle with its RS16 through a scene, at 3 m/s along y = 0 from s = 0 to 24 m, after standing for 4
/// s. Poses are the mapper's; `T_world_map` aligns its map with the scene.
struct SceneDrive {
  DriveTiles made;
  Pose T_world_map = Pose::Identity();
  std::vector<Eigen::Vector3d> eyes;  ///< positions of the lidar, world, about one per metre
};

[[nodiscard]] SceneDrive drive_scene(const CurbScene& scene, std::uint64_t seed);

}  // namespace curbstone::bench::curbs::scenes
