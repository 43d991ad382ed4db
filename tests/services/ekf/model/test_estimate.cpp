#include "services/ekf/model/estimate.hpp"

#include <gtest/gtest.h>

#include "tests/services/ekf/model/model_fixture.hpp"

namespace curbstone::ekf::model {
namespace {

using EstimateTest = ModelTest;

/// The covariance of base_link, with the IMU on a lever arm, is that of the errors that the belief's error causes.
TEST_F(EstimateTest, TheCovarianceIsThatOfBaseLink) {
  const Geometry geometry(vehicle_);
  const ErrorMatrix A = 1e-3 * ErrorMatrix::Random();
  Belief belief;
  belief.mean = state_;
  belief.covariance = A * A.transpose();
  constexpr double kRateSigma = 0.002;
  const Estimate estimate = estimate_base(belief, imu_, kRateSigma, geometry);

  const Pose base = base_pose(state_, geometry);
  const Eigen::MatrixXd by_pose = numeric([&](const ErrorVector& e) -> Eigen::VectorXd {
    const Pose other = base_pose(plus(state_, e), geometry);
    Eigen::VectorXd error(6);
    error << other.translation() - base.translation(),
        so3_log(Eigen::Quaterniond(base.linear().transpose() * other.linear()));
    return error;
  });
  const Eigen::MatrixXd pose = by_pose * belief.covariance * by_pose.transpose();
  EXPECT_LT((estimate.pose_covariance - pose).cwiseAbs().maxCoeff(), 1e-7 * pose.cwiseAbs().maxCoeff());

  const Eigen::MatrixXd by_twist = numeric([&](const ErrorVector& e) -> Eigen::VectorXd {
    const BodyMotion motion = body_motion(plus(state_, e), imu_.angular_rate, geometry);
    Eigen::VectorXd twist(6);
    twist << motion.velocity, motion.angular_rate;
    return twist;
  });
  Eigen::MatrixXd twist = by_twist * belief.covariance * by_twist.transpose();
  twist.diagonal().tail<3>().array() += kRateSigma * kRateSigma;
  EXPECT_LT((estimate.twist_covariance - twist).cwiseAbs().maxCoeff(), 1e-7 * twist.cwiseAbs().maxCoeff());
}

TEST_F(EstimateTest, TheAccelerationIsTheImusInOdomWithoutGravity) {
  const Geometry geometry(vehicle_);
  NavState rest;
  rest.attitude = Eigen::Quaterniond(rotation_from_rpy(0.1, -0.2, 0.7));
  const Eigen::Vector3d force = rest.attitude.conjugate() * Eigen::Vector3d(0.3, 0, kGravity);
  const Estimate estimate = estimate_base({.mean = rest}, {Eigen::Vector3d::Zero(), force}, 0, geometry);
  EXPECT_LT((estimate.acceleration - Eigen::Vector3d(0.3, 0, 0)).norm(), 1e-9);
}

}  // namespace
}  // namespace curbstone::ekf::model
