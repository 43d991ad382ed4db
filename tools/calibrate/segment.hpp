#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "tools/calibrate/calibration_data.hpp"

namespace curbstone::calibrate {

/// What the IMU says between two times, in the imu frame at the beginning (Forster et al. 2017, eq. 33; no bias taken
/// off the accelerometer).
struct ImuDelta {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Matrix3d rotation_by_bias = Eigen::Matrix3d::Zero();  ///< derivative of its log by the gyro's bias
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();          ///< m/s, of the specific force alone
  Eigen::Vector3d position = Eigen::Vector3d::Zero();          ///< m, likewise
};

/// A piece of the drive between two LiDAR poses.
struct CalibrationSegment {
  double duration = 0.0;                ///< s
  Pose T_map_begin = Pose::Identity();  ///< of the LiDAR
  Pose T_map_end = Pose::Identity();
  std::vector<std::array<double, 2>> wheels;  ///< rad that the left and the right wheel turned, step by step
  ImuDelta imu;
  bool follows = false;  ///< begins where the piece before it ends

  [[nodiscard]] Pose T_begin_end() const { return T_map_begin.inverse() * T_map_end; }
};

/// Cuts a drive into pieces of about `duration` s while it moves. Pieces with gaps in any of the sensors are left out.
[[nodiscard]] std::vector<CalibrationSegment> cut_segments(const CalibrationData& data, double duration);

}  // namespace curbstone::calibrate
