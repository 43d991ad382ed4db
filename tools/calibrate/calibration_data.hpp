#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "services/ekf/base/samples.hpp"

namespace curbstone::calibrate {

/// Where the LiDAR was at a time, in a map that stays.
struct LidarPose {
  std::int64_t utime = 0;  ///< us
  Pose T_map_lidar = Pose::Identity();
};

/// What a drive gives to calibrate with, each by stamp, ascending.
struct CalibrationData {
  std::vector<LidarPose> lidar;
  std::vector<ekf::base::WheelSample> wheels;
  std::vector<ekf::base::ImuSample> imu;
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();  ///< rad/s, imu frame, about: taken off before integration
  bool log_is_damaged = false;                          ///< parts of the log could not be read
};

}  // namespace curbstone::calibrate
