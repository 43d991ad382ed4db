// The filter's input: which part of a sample of the IMU is used, and with what weight.
#include "services/ekf/filter/filter.hpp"

namespace curbstone::ekf::filter {

/// The sample without what is known to be wrong. The noise is that of what the device sends, less a wrong vertical
/// force.
base::ImuSample Filter::usable_of(base::ImuSample measured) {
  base::ImuSample sample = axes_.add(measured, still_.wheels_turn() && !wheels_missing(measured.utime));
  if (started_) {
    const bool was_wrong = vertical_force_.wrong();
    sample = vertical_force_.usable(sample, belief_.mean, geometry_, noise_.accelerometer);
    if (vertical_force_.wrong() && !was_wrong) counters_.add("faults.vertical_force");
    measured.acceleration = sample.acceleration;
  }
  update_noise(measured);
  return sample;
}

/// Reduces the weight of an IMU that is noisier than configured wherever it is compared with the wheels.
void Filter::update_noise(const base::ImuSample& sample) {
  imu_noise_.add(sample);
  noise_ = imu_noise_.applied_to(config_->noise);
  excess_ = imu_noise_.beyond(config_->noise);
  const double gyro = excess_.gyro * excess_.per_sample;  // 1 sigma of a sample
  const double accelerometer = excess_.accelerometer * excess_.per_sample;
  mechanisation_.set_noise(noise_);
  if (launch_) launch_->set_noise(noise_);
  start_up_.set_noise(noise_, gyro, accelerometer);
  still_.set_noise(gyro, accelerometer);
  slip_.set_noise(excess_.gyro, excess_.accelerometer);
}

}  // namespace curbstone::ekf::filter
