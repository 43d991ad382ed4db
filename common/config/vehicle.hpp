#pragma once

#include <vector>

#include "common/config/config.hpp"
#include "common/geometry/geometry.hpp"

namespace curbstone {

/// The vehicle's properties on which several processes must agree: the `vehicle:` section of its file. A process uses
/// it through a member `VehicleConfig vehicle;` visited as section "vehicle". The loader fills it from the file's top
/// level.
///
/// base_link: midway between the driven wheels, on the ground; x forward, y left, z up.
struct VehicleConfig {
  double wheel_radius = 0.17;  ///< m, rolling
  double track_width = 0.80;   ///< m, between the driven wheels' contact points (effective, for turning)
  double width = 1.20;         ///< m, over all
  double length = 1.80;        ///< m, over all
  double middle = 0.0;         ///< m, x of the middle of that length
  double height = 2.00;        ///< m, over all: what hangs higher does not block
  std::vector<double> lidar = {0.0, 0.0, 1.73, 0.0, 0.0, 0.0};  ///< T_base_lidar: x y z m, roll pitch yaw rad
  std::vector<double> imu = {0.10, 0.05, 0.40, 0.0, 0.0, 0.0};  ///< T_base_imu: x y z m, roll pitch yaw rad

  void visit(ConfigVisitor& v) {
    v.field("wheel_radius", wheel_radius, {0.01, 2.0}, "m, rolling radius of the driven wheels");
    v.field("track_width", track_width, {0.05, 5.0}, "m, between the driven wheels (effective, for turning)");
    v.field("width", width, {0.1, 5.0}, "m, over all");
    v.field("length", length, {0.1, 15.0}, "m, over all");
    v.field("middle", middle, {-10.0, 10.0}, "m, how far the middle of that length is ahead of the driven wheels");
    v.field("height", height, {0.1, 5.0}, "m, over all; what hangs higher does not block");
    v.pose("lidar", lidar, {-20.0, 20.0}, "T_base_lidar: x y z in m, roll pitch yaw in rad");
    v.pose("imu", imu, {-20.0, 20.0}, "T_base_imu: x y z in m, roll pitch yaw in rad");
  }

  [[nodiscard]] Pose T_base_lidar() const { return pose(lidar); }
  [[nodiscard]] Pose T_base_imu() const { return pose(imu); }

 private:
  static Pose pose(const std::vector<double>& xyzrpy) {
    Pose T = Pose::Identity();
    T.translation() = Eigen::Vector3d(xyzrpy[0], xyzrpy[1], xyzrpy[2]);
    T.linear() = rotation_from_rpy(xyzrpy[3], xyzrpy[4], xyzrpy[5]);
    return T;
  }
};

}  // namespace curbstone
