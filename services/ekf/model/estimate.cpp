#include "services/ekf/model/estimate.hpp"

namespace curbstone::ekf::model {

Pose base_pose(const NavState& state, const Geometry& geometry) {
  Pose T_odom_base = Pose::Identity();
  T_odom_base.linear() = state.attitude.toRotationMatrix();
  T_odom_base.translation() = state.position + T_odom_base.linear() * geometry.to_base;
  return T_odom_base;
}

Estimate estimate_base(const Belief& belief, const Inertial& imu, double rate_sigma, const Geometry& geometry) {
  const NavState& x = belief.mean;
  const Eigen::Matrix3d R = x.attitude.toRotationMatrix();
  const BodyMotion motion = body_motion(x, imu.angular_rate, geometry);

  Estimate out;
  out.utime = belief.utime;
  out.T_odom_base = base_pose(x, geometry);
  out.velocity = motion.velocity;
  out.angular_rate = motion.angular_rate;
  out.acceleration = R * (imu.acceleration - x.accelerometer_bias) - Eigen::Vector3d(0, 0, kGravity);
  out.gyro_bias = geometry.R_base_imu.transpose() * x.gyro_bias;
  out.accelerometer_bias = geometry.R_base_imu.transpose() * x.accelerometer_bias;

  using Jacobian = Eigen::Matrix<double, 6, kErrorSize>;
  Jacobian pose = Jacobian::Zero();
  pose.block<3, 3>(0, kPosition).setIdentity();
  pose.block<3, 3>(0, kAttitude) = -R * skew(geometry.to_base);
  pose.block<3, 3>(3, kAttitude).setIdentity();
  out.pose_covariance = propagated(pose, belief.covariance);
  out.pose_covariance.diagonal() = out.pose_covariance.diagonal().cwiseMax(0.0);  // rounded below 0 at the origin

  Jacobian twist = Jacobian::Zero();
  twist.block<3, 3>(0, kVelocity).setIdentity();
  twist.block<3, 3>(0, kGyroBias) = skew(geometry.to_base);
  twist.block<3, 3>(3, kGyroBias) = -Eigen::Matrix3d::Identity();
  out.twist_covariance = propagated(twist, belief.covariance);
  out.twist_covariance.diagonal().tail<3>().array() += rate_sigma * rate_sigma;
  return out;
}

}  // namespace curbstone::ekf::model
