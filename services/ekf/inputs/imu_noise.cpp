#include "services/ekf/inputs/imu_noise.hpp"

#include <algorithm>
#include <cmath>

namespace curbstone::ekf::inputs {

namespace {

constexpr double kFloor = 1e-4;  // rad/s, m/s^2: for an axis that has had no noise yet, so that it can learn
constexpr double kUneven = 0.5;  // share of a step by which the next one may differ

/// Density to use: configured up to twice its value, then growing continuously towards the measured one.
double applied(double measured, double configured) {
  return std::max(configured, std::sqrt(std::max(0.0, measured * measured - 3.0 * configured * configured)));
}

}  // namespace

void ImuNoise::add(const base::ImuSample& sample) {
  const double step = base::seconds_between(last_.utime, sample.utime);
  const double step_before = base::seconds_between(before_.utime, last_.utime);
  if (known_ == 2 && step > 0.0 && std::abs(step - step_before) < kUneven * step_before) {
    step_ = 0.5 * (step + step_before);
    if (learnt_ < kMinSamples) ++learnt_;
    const double share = std::max(1.0 / learnt_, std::min(step_ / kMemory, 1.0));
    const bool bounded = learnt_ == kMinSamples;
    learn(gyro_, before_.angular_rate - 2.0 * last_.angular_rate + sample.angular_rate, share, bounded);
    learn(accelerometer_, before_.acceleration - 2.0 * last_.acceleration + sample.acceleration, share, bounded);
  }
  known_ = step > 0.0 ? std::min(known_ + 1, 2) : 1;
  before_ = last_;
  last_ = sample;
}

void ImuNoise::learn(Eigen::Array3d& variance, const Eigen::Vector3d& second_difference, double share, bool bounded) {
  Eigen::Array3d square = second_difference.array().square() / 6.0;
  if (bounded) square = square.min(kMaxSigmas * kMaxSigmas * variance.max(kFloor * kFloor));
  variance += share * (square - variance);
}

double ImuNoise::density_of(const Eigen::Array3d& variance) const {
  return learnt_ < kMinSamples ? 0.0 : std::sqrt(variance.mean() * step_);
}

base::NoiseConfig ImuNoise::applied_to(const base::NoiseConfig& configured) const {
  base::NoiseConfig noise = configured;
  noise.gyro = applied(gyro(), configured.gyro);
  noise.accelerometer = applied(accelerometer(), configured.accelerometer);
  return noise;
}

ImuNoise::Excess ImuNoise::beyond(const base::NoiseConfig& configured) const {
  const base::NoiseConfig noise = applied_to(configured);
  return {noise.gyro > configured.gyro ? noise.gyro : 0.0,
          noise.accelerometer > configured.accelerometer ? noise.accelerometer : 0.0,
          step_ > 0.0 ? std::sqrt(1.0 / step_) : 0.0};
}

}  // namespace curbstone::ekf::inputs
