#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

namespace curbstone::ekf::base {

/// One IMU sample in the imu frame, checked: finite and within the range of a sensor.
struct ImuSample {
  std::int64_t utime = 0;                                  ///< us, time of sampling
  Eigen::Vector3d angular_rate = Eigen::Vector3d::Zero();  ///< rad/s
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  ///< specific force, m/s^2
  std::array<bool, 3> stuck = {};                          ///< gyro axes that the driver reports as stuck
  /// rad, to be added to the yaw of vehicle.imu: by so much rate and acceleration have been turned, as the imu frame
  /// that the file declares would show them.
  double turned = 0.0;
};

/// Angles of both wheels at one instant: left, right; positive is forward.
struct WheelSample {
  std::int64_t utime = 0;            ///< us, time at which the counts were sampled
  std::array<double, 2> angle = {};  ///< rad, from an arbitrary zero
};

inline constexpr double kSecondsPerMicrosecond = 1e-6;

/// Seconds from `from` to `to` (us).
[[nodiscard]] inline double seconds_between(std::int64_t from, std::int64_t to) {
  return kSecondsPerMicrosecond * static_cast<double>(to - from);
}

}  // namespace curbstone::ekf::base
