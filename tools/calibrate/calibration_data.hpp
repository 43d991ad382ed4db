#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "services/ekf/base/samples.hpp"

namespace curbstone::calibrate {

/// A pose of the LiDAR in a fixed map.
struct LidarPose {
  std::int64_t utime = 0;  ///< us
  Pose T_map_lidar = Pose::Identity();
};

/// The input of the calibration, each list in ascending order of time.
struct CalibrationData {
  std::vector<LidarPose> lidar;
  std::vector<ekf::base::WheelSample> wheels;
  std::vector<ekf::base::ImuSample> imu;
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();  ///< rad/s, imu frame, rough; subtracted before integration
  bool log_is_damaged = false;                          ///< parts of the log could not be read
};

}  // namespace curbstone::calibrate
