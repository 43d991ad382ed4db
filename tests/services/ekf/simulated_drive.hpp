#pragma once

#include <random>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "services/ekf/base/ekf_config.hpp"
#include "services/ekf/base/samples.hpp"

namespace curbstone::ekf {

/// A drive whose truth is known: a vehicle on hilly ground that curves, stops and goes on, with an IMU and wheels as
/// bad as given. Deterministic by seed.
struct DriveOptions {
  double seconds = 60.0;
  double speed = 3.0;                                            ///< m/s
  double stand_first = 2.0;                                      ///< s
  double stop_at = 30.0;                                         ///< s; it stands for 4 s; beyond the end: no stop
  double spin = 0.0;                                             ///< rad/s, on the spot, while it stands at `stop_at`
  double spin_seconds = 0.0;                                     ///< that it stands longer for it
  double circle = 0.0;                                           ///< rad/s at `speed`, all the way to the left
  double hills = 0.05;                                           ///< rad, amplitude of pitch; roll is 0.6 of it
  double curves = 0.3;                                           ///< rad/s, amplitude of the yaw rate
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();           ///< rad/s
  Eigen::Vector3d accelerometer_bias = Eigen::Vector3d::Zero();  ///< m/s^2
  double gyro_noise = 2e-4;                                      ///< rad/s/sqrt(Hz)
  double accelerometer_noise = 2e-3;                             ///< m/s^2/sqrt(Hz)
  double gyro_bias_walk = 0.0;                                   ///< rad/s/sqrt(s)
  double accelerometer_bias_walk = 0.0;                          ///< m/s^2/sqrt(s)
  Eigen::Vector3d wheel_scale = Eigen::Vector3d::Zero();         ///< left radius, right radius, track; see NavState
  double counts_per_turn = 16384.0;                              ///< quantisation of the wheel angle
  double wheel_speed_noise = 0.0;      ///< m/s, 1 sigma of each wheel's mean speed over `wheel_noise_interval`
  double wheel_noise_interval = 0.05;  ///< s
  double stamp_jitter = 0.0;           ///< s, 1 sigma, of the wheels
  double slip_begin = 1e9;             ///< s
  double slip_end = 1e9;               ///< s
  double slip_left = 0.0;              ///< share of the speed by which the left wheel turns too fast
  double slip_right = 0.0;
  unsigned seed = 1;
};

struct TruePose {
  std::int64_t utime = 0;
  Pose T_world_base = Pose::Identity();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< of base_link, in base_link
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();
  Eigen::Vector3d accelerometer_bias = Eigen::Vector3d::Zero();
};

struct Drive {
  std::vector<base::ImuSample> imu;       ///< 100 Hz
  std::vector<base::WheelSample> wheels;  ///< 100 Hz, 4 ms after the IMU's stamps
  std::vector<TruePose> truth;            ///< at the IMU's stamps
  double distance = 0.0;                  ///< m

  /// The true pose at a time, in the frame that the filter calls odom if it started at `start`: there base_link is at
  /// the origin with yaw 0.
  [[nodiscard]] Pose T_odom_base(std::size_t index, std::size_t start) const;
  /// Index into `truth`.
  [[nodiscard]] std::size_t index_of(std::int64_t utime) const;
};

[[nodiscard]] Drive simulate_drive(const DriveOptions& options, const VehicleConfig& vehicle);

}  // namespace curbstone::ekf
