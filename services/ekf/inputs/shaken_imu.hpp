#pragma once

#include <cstdint>

#include "services/ekf/base/ekf_config.hpp"
#include "services/ekf/base/samples.hpp"
#include "services/ekf/inputs/imu_noise.hpp"

namespace curbstone::ekf::inputs {

/// Detects an IMU that is shaken so hard that the wheels alone give better odometry. The measure is the tilt error that
/// remains when white noise of the gyro (density q_g, rad/s/sqrt(Hz)) is integrated and corrected by gravity in white
/// noise of the accelerometer (q_a, m/s^2/sqrt(Hz)). The steady state of that scalar Kalman filter, whose random walk
/// is q_g^2 and whose measurement noise is (q_a / g)^2, is sigma^2 = q_g q_a / g.
///
/// Beyond kDrop times `start.level_sigma` the IMU is not used: it would cost the filter its level, and with that the
/// mapper its odometry (LevelWatch). It is used again once sigma has been below half of that for kTrust. Only noise
/// beyond the configured one counts. A value type; one thread; samples in the order of their stamps.
class ShakenImu {
 public:
  static constexpr double kDrop = 3.0;               ///< times level_sigma; LevelWatch gives up at 4
  static constexpr std::int64_t kTrust = 2'000'000;  ///< us

  explicit ShakenImu(const base::EkfConfig& config) : config_(config.noise), level_sigma_(config.start.level_sigma) {}

  /// Adds a sample. Returns whether the IMU is too noisy to be used as of this sample.
  bool add(const base::ImuSample& sample);
  [[nodiscard]] bool shaken() const { return shaken_; }
  [[nodiscard]] const ImuNoise& noise() const { return noise_; }
  /// rad, 1 sigma, see above; 0 while neither part is noisier than configured.
  [[nodiscard]] double tilt_sigma() const;

 private:
  base::NoiseConfig config_;
  double level_sigma_;  // rad
  ImuNoise noise_;
  bool shaken_ = false;
  std::int64_t calm_since_ = 0;  // us, while shaken: the first sample of the calm
  bool calm_ = false;
};

}  // namespace curbstone::ekf::inputs
