#include "services/localizer/tracking/prediction.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace curbstone::localizer::tracking {
namespace {

PoseBelief uncertain_belief() {
  PoseBelief belief;
  belief.T_map_base.translation() << 12, -7, 1;
  belief.T_map_base.linear() = rotation_from_rpy(0.05, -0.1, 2.2);
  const Matrix6 A = 0.02 * Matrix6::Random();
  belief.covariance = A * A.transpose();
  return belief;
}

Motion bend() {
  Motion motion;
  motion.T_last_base.translation() << 1.5, 0.2, -0.05;
  motion.T_last_base.linear() = rotation_from_rpy(0.01, 0.02, 0.3);
  motion.seconds = 0.1;
  return motion;
}

TrackingConfig exact_odometry() {
  TrackingConfig config;
  config.odometry_m = config.odometry_rad = config.odometry_floor_m = config.odometry_floor_rad = 0;
  return config;
}

TEST(Prediction, CarriesTheErrorOfThePoseAlongTheMotion) {
  const PoseBelief before = uncertain_belief();
  const PoseBelief after = predicted(before, bend(), exact_odometry());
  EXPECT_TRUE(after.T_map_base.isApprox(before.T_map_base * bend().T_last_base, 1e-12));
  Matrix6 F;
  for (int i = 0; i < 6; ++i) {
    const auto error_by = [&](double size) {
      const Pose other = moved_by(before.T_map_base, size * Vector6::Unit(i)) * bend().T_last_base;
      return error_between(after.T_map_base, other);
    };
    F.col(i) = (error_by(1e-5) - error_by(-1e-5)) / 2e-5;
  }
  EXPECT_LT((after.covariance - F * before.covariance * F.transpose()).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(Prediction, AddsTheErrorOfOdometryAndMoreWithoutIt) {
  PoseBelief before = uncertain_belief();
  before.covariance.setZero();
  TrackingConfig config = exact_odometry();
  config.odometry_m = 0.02;
  config.odometry_rad = 0.03;
  config.odometry_floor_m = 0.001;
  config.odometry_floor_rad = 0.0002;
  Motion motion = bend();
  const double position = 0.001 + 0.02 * motion.T_last_base.translation().norm();
  const double rotation = 0.0002 + 0.03 * angle_of(motion.T_last_base);
  const Matrix6 with = predicted(before, motion, config).covariance;
  EXPECT_NEAR(with(0, 0), position * position, 1e-12);
  EXPECT_NEAR(with(5, 5), rotation * rotation, 1e-12);
  motion.with_odometry = false;
  const Matrix6 without = predicted(before, motion, config).covariance;
  EXPECT_NEAR(without(1, 1), std::pow(position + 1.0 * 0.1, 2), 1e-12);
  EXPECT_NEAR(without(5, 5), std::pow(rotation + 0.3 * 0.1, 2), 1e-12);
}

TEST(Prediction, AVehicleThatIsLostIsNotSoughtFartherThanAGaussianHolds) {
  PoseBelief belief = uncertain_belief();
  Motion blind = bend();
  blind.with_odometry = false;
  blind.seconds = 5;
  for (int i = 0; i < 20; ++i) belief = predicted(belief, blind, {});
  EXPECT_LE(belief.covariance.diagonal().head<3>().maxCoeff(), 2.0 * 2.0 + 1e-9);
  EXPECT_LE(belief.covariance.diagonal().tail<3>().maxCoeff(), 0.2 * 0.2 + 1e-9);
}

}  // namespace
}  // namespace curbstone::localizer::tracking
