#include <gtest/gtest.h>

#include <numbers>

#include "tests/tools/simulate/drives.hpp"

namespace curbstone::simulate::motion {
namespace {

TEST(TownMotion, GoesAsFarAsItsSpeedProfileSays) {
  const motion::TownMotion& motion = test_motion();
  double way = 0;
  for (int i = 0; i < 4000; ++i) {
    const Eigen::Vector3d step =
        motion.T_world_base(0.01 * (i + 1)).translation() - motion.T_world_base(0.01 * i).translation();
    way += step.head<2>().norm();
  }
  EXPECT_NEAR(way, motion.profile().distance(40), 0.01);
}

TEST(TownMotion, HeadsWhereItGoes) {
  const motion::TownMotion& motion = test_motion();
  for (double t = 9.5; t < 29.5; t += 0.5) {
    const Pose T = motion.T_world_base(t);
    const Eigen::Vector3d v =
        T.linear().transpose() *
        (motion.T_world_base(t + 0.01).translation() - motion.T_world_base(t - 0.01).translation()) / 0.02;
    EXPECT_NEAR(v.x(), 3.0, 0.02) << t;
    EXPECT_NEAR(v.y(), 0.0, 0.01) << "wheels do not slide sideways";
  }
}

TEST(TownMotion, ComesRoundTheBlock) {
  const motion::TownMotion motion(test_town(), {}, motion::SpeedProfile({}, 400));
  double nearest = 1e9;
  const Eigen::Vector3d start = motion.T_world_base(0).translation();
  for (double t = 60; t < 200; t += 0.1)
    nearest = std::min(nearest, (motion.T_world_base(t).translation() - start).norm());
  EXPECT_LT(nearest, 0.3);
}

/// A drive with a manoeuvre at each stop. The acceleration is the default one: ramps of 5 s.
const motion::TownMotion& manoeuvres() {
  static const motion::TownMotion motion(test_town(), {}, motion::SpeedProfile({.drive = 8, .manoeuvres = true}, 150));
  return motion;
}

double yaw_of(const Pose& T) {
  return std::atan2(T.linear()(1, 0), T.linear()(0, 0));
}

TEST(TownMotion, NeverSlidesSidewaysInAManoeuvre) {
  double fastest = 0, backmost = 0;
  for (double t = 0; t < 150; t += 0.1) {
    const Eigen::Vector3d v =
        manoeuvres().T_world_base(t).linear().transpose() *
        (manoeuvres().T_world_base(t + 0.005).translation() - manoeuvres().T_world_base(t - 0.005).translation()) /
        0.01;
    fastest = std::max(fastest, v.x());
    backmost = std::min(backmost, v.x());
    EXPECT_NEAR(v.y(), 0.0, 0.01) << t;
  }
  EXPECT_NEAR(fastest, 3.0, 0.02);
  EXPECT_NEAR(backmost, -3.0, 0.02) << "a whole leg is driven backwards";
}

TEST(TownMotion, TurnsOnTheSpotInAManoeuvre) {
  double turned = 0, moved = 0;  // while the route's speed is 0
  for (double t = 0; t < 150; t += 0.05) {
    if (manoeuvres().profile().speed(t) != 0 || manoeuvres().profile().speed(t + 0.05) != 0) continue;
    const Pose from = manoeuvres().T_world_base(t), to = manoeuvres().T_world_base(t + 0.05);
    turned += std::abs(std::remainder(yaw_of(to) - yaw_of(from), 2.0 * std::numbers::pi));
    moved += (to.translation() - from.translation()).norm();
  }
  EXPECT_NEAR(turned, 4.0 * std::numbers::pi, 0.02) << "once round, half round and back";
  EXPECT_LT(moved, 1e-3);
}

TEST(Inertia, IsGravityAloneAtRest) {
  const motion::Inertia rest = motion::inertia_at(test_motion(), VehicleConfig{}.T_base_imu(), 1.0);
  EXPECT_NEAR(rest.specific_force.norm(), kGravity, 1e-6);
  EXPECT_NEAR(rest.angular_rate.norm(), 0, 1e-9);
}

// The oracle of any inertial simulation: integrating what an ideal IMU measures gives the true motion again.
TEST(Inertia, IntegratesToTheTrueMotion) {
  const motion::TownMotion& motion = test_motion();
  const Pose T_base_imu = VehicleConfig{}.T_base_imu();
  constexpr double kStep = 1e-3;
  Pose T = motion.T_world_base(3.0) * T_base_imu;
  Eigen::Quaterniond q(T.linear());
  Eigen::Vector3d p = T.translation(), v = Eigen::Vector3d::Zero();
  for (double t = 3.0; t < 33.0 - 1e-9; t += kStep) {
    const motion::Inertia middle = motion::inertia_at(motion, T_base_imu, t + 0.5 * kStep);
    const Eigen::Quaterniond half = q * so3_exp(0.5 * kStep * middle.angular_rate);
    const Eigen::Vector3d a = half * middle.specific_force - Eigen::Vector3d(0, 0, kGravity);
    p += v * kStep + 0.5 * kStep * kStep * a;
    v += a * kStep;
    q = q * so3_exp(kStep * middle.angular_rate);
  }
  const Pose truth = motion.T_world_base(33.0) * T_base_imu;
  EXPECT_LT((p - truth.translation()).norm(), 0.15) << "after 30 s and some 80 m";
  EXPECT_LT(so3_log(q.conjugate() * Eigen::Quaterniond(truth.linear())).norm(), 1e-3);
}

}  // namespace
}  // namespace curbstone::simulate::motion
