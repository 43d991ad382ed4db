#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace curbstone::bench::voting::inputs {

/// Makes the street cloud for the comparison of tensor voting codes (reference: tensor voting, section 12), in m: road
/// |y| < 3.5 at z = 0, curb faces 15 cm high, pavement out to |y| = 9, walls there from z = 0 to 2; uniform by area, 1
/// cm of Gaussian noise on every coordinate. Each seed gives another draw.
[[nodiscard]] std::vector<Eigen::Vector3d> street_cloud(std::size_t points, double length = 20, unsigned seed = 1);

/// m^2 of surface per metre of length: 446 m^2 for 20 m.
inline constexpr double kStreetArea = 7 + 2 * 0.15 + 2 * 5.5 + 2 * 2.0;

}  // namespace curbstone::bench::voting::inputs
