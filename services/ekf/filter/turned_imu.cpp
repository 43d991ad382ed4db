#include "services/ekf/filter/turned_imu.hpp"

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

}  // namespace curbstone::ekf::filter
