#pragma once

#include <array>
#include <deque>

#include "services/ekf/base/ekf_config.hpp"
#include "services/ekf/base/samples.hpp"

namespace curbstone::ekf::detection {

/// Decides whether the vehicle stands: wheels without travel AND a quiet IMU over the last `window` seconds. The test
/// uses the variance of the IMU and not its value, which is mostly bias.
class StillDetector {
 public:
  StillDetector(const base::StandstillConfig& config, double wheel_radius, double max_wheel_gap)
      : config_(config), radius_(wheel_radius), max_wheel_gap_(max_wheel_gap) {}

  void add(const base::ImuSample& sample);
  void add(const base::WheelSample& sample);
  /// 1 sigma of an IMU sample (rad/s, m/s^2) where the IMU is noisier than configured: raises the thresholds
  /// accordingly.
  void set_noise(double gyro, double accelerometer) { noise_ = {gyro, accelerometer}; }
  void reset();

  /// State as of the newest IMU sample. `gyro_bias` (imu frame) tells an even turn from a standstill.
  [[nodiscard]] bool still(const Eigen::Vector3d& gyro_bias) const;
  /// Whether neither wheel travels.
  [[nodiscard]] bool wheels_rest() const;
  /// Whether both wheels have travelled by far more than noise.
  [[nodiscard]] bool wheels_turn() const;

  /// Means of the IMU over the window, imu frame; `span` is the length of the data in it, s.
  [[nodiscard]] const Eigen::Vector3d& mean_rate() const { return mean_rate_; }
  [[nodiscard]] const Eigen::Vector3d& mean_acceleration() const { return mean_acceleration_; }
  [[nodiscard]] double span() const;
  [[nodiscard]] const std::deque<base::WheelSample>& wheels() const { return wheels_; }

 private:
  [[nodiscard]] std::array<double, 2> travel() const;  // m, between the extremes in the window

  base::StandstillConfig config_;
  double radius_;         // m
  double max_wheel_gap_;  // s
  std::deque<base::ImuSample> imu_;
  std::deque<base::WheelSample> wheels_;
  std::array<double, 2> noise_ = {};
  Eigen::Vector3d mean_rate_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_acceleration_ = Eigen::Vector3d::Zero();
  bool quiet_ = false;
};

}  // namespace curbstone::ekf::detection
