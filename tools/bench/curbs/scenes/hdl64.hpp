#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "tools/simulate/world/scene.hpp"

namespace curbstone::bench::curbs::scenes {

/// Simulates one revolution of a standing Velodyne HDL-64E (its manual: 32 beams from +2 to -8.33 deg, 32 from -8.83 to
/// -24.33 deg; 10 Hz, 0.1728 deg between shots) in a scene. Points in the lidar frame, m; `noise`: of the range, m, 1
/// sigma.
[[nodiscard]] std::vector<Eigen::Vector3f> scan_hdl64(const simulate::world::Scene& scene, const Pose& T_world_lidar,
                                                      double noise, std::uint64_t seed);

}  // namespace curbstone::bench::curbs::scenes
