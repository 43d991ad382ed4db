#pragma once

#include <cstdint>

#include "services/ekf/base/ekf_config.hpp"
#include "services/ekf/base/samples.hpp"

namespace curbstone::ekf::inputs {

/// How noisy the IMU is, measured while it runs. A vehicle that shakes, a mount that is loose or a poor unit makes an
/// IMU many times noisier than a file says, and a filter that does not know takes noise for turns and for wheels that
/// slip.
///
/// White noise of 1 sigma s gives a second difference x[k-1] - 2 x[k] + x[k+1] of sqrt(6) s, in which what the vehicle
/// does hardly shows: 5 Hz at 100 samples a second come to a tenth. Squares are averaged over the axes and
/// about kMemory, which is right to a fifth, and a single leap counts as kMost times the noise at most. Pure; one
/// thread; a value type.
class ImuNoise {
 public:
  static constexpr double kMemory = 1.0;  ///< s
  static constexpr double kMost = 3.0;    ///< sigma

  /// The next sample. One that does not follow the two before at their pace says nothing.
  void add(const base::ImuSample& sample);

  /// Density, 1 sigma: rad/s/sqrt(Hz), m/s^2/sqrt(Hz). 0 until kLeast samples have been seen.
  [[nodiscard]] double gyro() const { return density_of(gyro_); }
  [[nodiscard]] double accelerometer() const { return density_of(accelerometer_); }

  /// As configured; larger where the IMU is clearly noisier (twice) than that.
  [[nodiscard]] base::NoiseConfig applied_to(const base::NoiseConfig& configured) const;
  /// Densities where applied_to() makes them larger than configured; else 0.
  struct Excess {
    double gyro = 0.0, accelerometer = 0.0;
    double per_sample = 0.0;  ///< 1/sqrt(s): times it, a density is 1 sigma of a sample
  };
  [[nodiscard]] Excess beyond(const base::NoiseConfig& configured) const;

 private:
  static constexpr int kLeast = 30;
  /// Mean squares of an IMU's part, by axis.
  struct Axes {
    Eigen::Array3d square = Eigen::Array3d::Zero();
  };
  static void learn(Axes& axes, const Eigen::Vector3d& second_difference, double share, bool bounded);
  [[nodiscard]] double density_of(const Axes& axes) const;

  base::ImuSample before_, last_;
  int known_ = 0;    // samples in a row, at most 2
  int learnt_ = 0;   // differences, at most kLeast
  double step_ = 0;  // s between samples
  Axes gyro_, accelerometer_;
};

}  // namespace curbstone::ekf::inputs
