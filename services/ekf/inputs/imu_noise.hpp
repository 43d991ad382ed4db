#pragma once

#include <cstdint>

#include "services/ekf/base/ekf_config.hpp"
#include "services/ekf/base/samples.hpp"

namespace curbstone::ekf::inputs {

/// Measures the IMU's white noise while it runs. A vehicle that shakes, a loose mount or a poor unit makes an IMU many
/// times noisier than configured, and a filter that does not know takes the noise for turns and for slip.
///
/// White noise of 1 sigma s gives a second difference x[k-1] - 2 x[k] + x[k+1] of 1 sigma sqrt(6) s, in which the
/// vehicle's motion hardly shows: motion at 5 Hz, sampled at 100 Hz, contributes a tenth of its amplitude. Squares are
/// averaged over the axes and about kMemory, which is accurate to a fifth; a single leap counts as at most kMaxSigmas
/// times the noise. Pure; one thread; a value type.
class ImuNoise {
 public:
  static constexpr double kMemory = 1.0;     ///< s
  static constexpr double kMaxSigmas = 3.0;  ///< sigma

  /// Adds the next sample. It is ignored if it does not follow the two before at their interval.
  void add(const base::ImuSample& sample);

  /// Density, 1 sigma: rad/s/sqrt(Hz), m/s^2/sqrt(Hz). 0 until kMinSamples samples have been seen.
  [[nodiscard]] double gyro() const { return density_of(gyro_); }
  [[nodiscard]] double accelerometer() const { return density_of(accelerometer_); }

  /// The configured density c, or from a measured density m of 2 c on sqrt(m^2 - 3 c^2), which grows continuously from
  /// c towards m.
  [[nodiscard]] base::NoiseConfig applied_to(const base::NoiseConfig& configured) const;
  /// Densities of applied_to() where they exceed the configured ones; else 0.
  struct Excess {
    double gyro = 0.0, accelerometer = 0.0;
    double per_sample = 0.0;  ///< 1/sqrt(s): factor from a density to 1 sigma of a sample
  };
  [[nodiscard]] Excess beyond(const base::NoiseConfig& configured) const;

 private:
  static constexpr int kMinSamples = 30;
  static void learn(Eigen::Array3d& variance, const Eigen::Vector3d& second_difference, double share, bool bounded);
  [[nodiscard]] double density_of(const Eigen::Array3d& variance) const;

  base::ImuSample before_, last_;
  int known_ = 0;    // samples in a row, at most 2
  int learnt_ = 0;   // differences, at most kMinSamples
  double step_ = 0;  // s between samples
  // Variances of a sample, by axis: rad^2/s^2, m^2/s^4.
  Eigen::Array3d gyro_ = Eigen::Array3d::Zero();
  Eigen::Array3d accelerometer_ = Eigen::Array3d::Zero();
};

}  // namespace curbstone::ekf::inputs
