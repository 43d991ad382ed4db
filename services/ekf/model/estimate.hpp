#pragma once

#include "services/ekf/model/measurement_model.hpp"

namespace curbstone::ekf::model {

/// The filter's estimate of base_link at a time (us).
struct Estimate {
  std::int64_t utime = 0;
  Pose T_odom_base = Pose::Identity();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();            ///< of base_link, in base_link, m/s
  Eigen::Vector3d angular_rate = Eigen::Vector3d::Zero();        ///< in base_link, rad/s
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();        ///< of the IMU, in odom, without gravity, m/s^2
  Eigen::Vector3d gyro_bias = Eigen::Vector3d::Zero();           ///< imu frame, rad/s
  Eigen::Vector3d accelerometer_bias = Eigen::Vector3d::Zero();  ///< imu frame, m/s^2
  Eigen::Matrix<double, 6, 6> pose_covariance;                   ///< x y z (odom), rotation about X Y Z (base_link)
  Eigen::Matrix<double, 6, 6> twist_covariance;                  ///< vx vy vz, wx wy wz (base_link)
  bool level = true;  ///< roll and pitch are known well enough: they will not swing by degrees soon
  bool stationary = false;
  bool slipping = false;
  bool no_imu = false;          ///< coasting on wheels alone
  bool no_wheels = false;       ///< coasting on the IMU alone
  bool turn_confirmed = false;  ///< wheels and gyro have shown the same turn over the last second
};

/// T_odom_base of a state.
[[nodiscard]] Pose base_pose(const NavState& state, const Geometry& geometry);

/// Transforms the belief, which is that of the IMU, to base_link. `imu` in body axes; `rate_sigma` is its noise in
/// rad/s.
[[nodiscard]] Estimate estimate_base(const Belief& belief, const Inertial& imu, double rate_sigma,
                                     const Geometry& geometry);

}  // namespace curbstone::ekf::model
