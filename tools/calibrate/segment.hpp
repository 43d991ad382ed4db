#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "tools/calibrate/calibration_data.hpp"

namespace curbstone::calibrate {

/// The preintegrated IMU motion between two times, in the imu frame at the beginning (Forster et al. 2017, eq. 33;
/// without an accelerometer bias).
struct ImuDelta {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Matrix3d rotation_by_bias = Eigen::Matrix3d::Zero();  ///< derivative of its log by the gyro bias
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();          ///< m/s, of the specific force only
  Eigen::Vector3d position = Eigen::Vector3d::Zero();          ///< m, likewise
};

/// A piece of the drive between two LiDAR poses.
struct CalibrationSegment {
  double duration = 0.0;                ///< s
  Pose T_map_begin = Pose::Identity();  ///< of the LiDAR
  Pose T_map_end = Pose::Identity();
  std::vector<std::array<double, 2>> wheels;  ///< rad turned by the left and the right wheel, step by step
  ImuDelta imu;
  bool follows = false;  ///< begins where the previous piece ends

  [[nodiscard]] Pose T_begin_end() const { return T_map_begin.inverse() * T_map_end; }
};

/// Cuts the moving parts of a drive into pieces of about `duration` s. Pieces with gaps in any sensor are left out.
[[nodiscard]] std::vector<CalibrationSegment> cut_segments(const CalibrationData& data, double duration);

}  // namespace curbstone::calibrate
