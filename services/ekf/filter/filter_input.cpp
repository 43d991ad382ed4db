// The filter's input: which part of a sample of the IMU is used, with what weight, and turned by what.
#include "services/ekf/filter/covariance_inflation.hpp"
#include "services/ekf/filter/filter.hpp"
#include "services/ekf/filter/turned_imu.hpp"

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

/// The IMU's samples are turned by `to` (rad) from now on, as its mounting is found to have another yaw. During a
/// launch the belief without the wheels is right but for that: they have been compared with another axis.
void Filter::turn_imu(double to) {
  counters_.add("imu_turned");
  const Pose before = model::base_pose(belief_.mean, geometry_);
  const Eigen::Vector3d position = belief_.mean.position;
  const bool inertial = launch_ || wheels_rejected_ || watch_.all_faulty();
  const double yaw = to - belief_.imu_turn;
  belief_ = with_turned_imu(launch_ ? launch_->belief() : belief_, yaw, set_off_from_, inertial);
  belief_.imu_turn = to;
  belief_.mean.position = position;
  if (!inertial) inflate_motion_covariance(belief_, belief_.mean.velocity.norm(), config_->start);
  detection::reset_wheel_scale(belief_, config_->wheels);
  detection::reset_axle(belief_, config_->wheels);
  smoother_.corrected(before, model::base_pose(belief_.mean, geometry_));
  mechanisation_.reset();
  watch_ = wheel_faults::WheelWatch(config_->slip, config_->vehicle.track_width);
  restart_comparisons();
}

}  // namespace curbstone::ekf::filter
