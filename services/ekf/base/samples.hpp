#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

namespace curbstone::ekf::base {

/// One IMU sample, imu frame, checked: finite and within what a sensor can show.
struct ImuSample {
  std::int64_t utime = 0;                                  ///< us, when it was taken
  Eigen::Vector3d angular_rate = Eigen::Vector3d::Zero();  ///< rad/s
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  ///< specific force, m/s^2
  std::array<bool, 3> stuck = {};                          ///< axes of the gyro that are, as its driver says
};

/// Both wheels at one instant: left, right; positive is forward.
struct WheelSample {
  std::int64_t utime = 0;            ///< us, when the counts were sampled
  std::array<double, 2> angle = {};  ///< rad since some start
};

inline constexpr double kSecondsPerMicrosecond = 1e-6;

/// s from `from` to `to`.
[[nodiscard]] inline double seconds_between(std::int64_t from, std::int64_t to) {
  return kSecondsPerMicrosecond * static_cast<double>(to - from);
}

}  // namespace curbstone::ekf::base
