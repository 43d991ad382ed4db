#pragma once

#include <Eigen/Geometry>

#include "common/config/vehicle.hpp"

namespace curbstone {

/// The box in which the LiDAR sees the vehicle itself, in base_link, m. It does not include the ground below.
[[nodiscard]] inline Eigen::AlignedBox3f own_body(const VehicleConfig& vehicle) {
  constexpr double kMargin = 0.1;  // m
  const double half_length = 0.5 * vehicle.length + kMargin;
  const double half_width = 0.5 * vehicle.width + kMargin;
  const Eigen::Vector3d rear_right(vehicle.middle - half_length, -half_width, kMargin);
  const Eigen::Vector3d front_left(vehicle.middle + half_length, half_width, vehicle.height + kMargin);
  return {rear_right.cast<float>(), front_left.cast<float>()};
}

}  // namespace curbstone
