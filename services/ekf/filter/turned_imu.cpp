#include "services/ekf/filter/turned_imu.hpp"

#include "services/ekf/filter/covariance_inflation.hpp"
#include "services/ekf/filter/filter.hpp"

namespace curbstone::ekf::filter {

model::Belief with_turned_imu(model::Belief belief, double yaw, const Eigen::Vector3d& from, bool inertial) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()));
  model::NavState& mean = belief.mean;
  if (inertial) mean.velocity = turn * mean.velocity;
  mean.attitude = (turn * mean.attitude * turn.conjugate()).normalized();
  mean.gyro_bias = turn * mean.gyro_bias;
  mean.accelerometer_bias = turn * mean.accelerometer_bias;

  model::ErrorMatrix turn_errors = model::ErrorMatrix::Identity();
  for (const int part :
       {model::kPosition, model::kVelocity, model::kAttitude, model::kGyroBias, model::kAccelerometerBias})
    turn_errors.block<3, 3>(part, part) = turn.toRotationMatrix();
  belief.covariance = model::propagated(turn_errors, belief.covariance);
  const Eigen::Vector3d way = mean.position - from;
  const Eigen::Vector3d kept = turn * way - way;
  belief.covariance.block<3, 3>(model::kPosition, model::kPosition) += kept * kept.transpose();
  return belief;
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
