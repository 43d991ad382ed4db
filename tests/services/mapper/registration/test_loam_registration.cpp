#include "services/mapper/registration/loam_registration.hpp"

#include <gtest/gtest.h>

#include "tests/services/mapper/synthetic_world.hpp"

namespace curbstone::mapper::registration {
namespace {

PosePrior known(const Pose& T_map_base, double sigma_m, double sigma_rad) {
  Vector6 d;
  d << Eigen::Vector3d::Constant(1 / (sigma_m * sigma_m)), Eigen::Vector3d::Constant(1 / (sigma_rad * sigma_rad));
  return {T_map_base, d.asDiagonal()};
}

/// A map of a world as a vehicle makes it that drives 3 m into it.
LoamRegistration loam_map(const test::SyntheticWorld& world) {
  LoamRegistration loam{config::LoamConfig{}, test::default_lidar().translation()};
  for (int i = 0; i <= 20; ++i) {
    const Pose T = test::pose(-3 + 0.15 * i, 0, 0, 0, 0, 0);
    loam.insert(world.snapshot(T, test::default_lidar()), T);
  }
  return loam;
}

double turn_of(const Pose& T) {
  return so3_log(Eigen::Quaterniond(T.linear())).norm();
}

TEST(LoamRegistration, RecoversAKnownPoseInAStreet) {
  test::SyntheticWorld world = test::street();
  world.noise = 0.01;
  LoamRegistration loam = loam_map(world);
  const Pose truth = test::pose(0.1, -0.08, 0.03, 0.004, -0.006, 0.02);
  const RegistrationResult result =
      loam.align(world.snapshot(truth, test::default_lidar()), known(Pose::Identity(), 1, 0.1));
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.degenerate, 0);
  const Pose error = truth.inverse() * result.T_map_base;
  EXPECT_LT(error.translation().norm(), 0.01);
  EXPECT_LT(turn_of(error), 1e-3);
  EXPECT_GT(result.inlier_ratio, 0.9);
  EXPECT_LT(result.residual, 0.04);
}

TEST(LoamRegistration, GivesTheSameBitsAgain) {
  test::SyntheticWorld world = test::street();
  world.noise = 0.01;
  LoamRegistration one = loam_map(world), other = loam_map(world);
  const auto points = world.snapshot(test::pose(0.1, -0.08, 0.03, 0.004, -0.006, 0.02), test::default_lidar());
  const RegistrationResult a = one.align(points, known(Pose::Identity(), 1, 0.1));
  const RegistrationResult b = other.align(points, known(Pose::Identity(), 1, 0.1));
  EXPECT_EQ(a.T_map_base.matrix(), b.T_map_base.matrix());
  EXPECT_EQ(a.covariance, b.covariance);
}

TEST(LoamRegistration, InATunnelFollowsThePriorAlongItAndSaysSo) {
  const test::SyntheticWorld world = test::tunnel();
  LoamRegistration loam = loam_map(world);
  const Pose truth = test::pose(0, 0.05, 0.02, 0, 0, 0.01);
  const RegistrationResult result =
      loam.align(world.snapshot(truth, test::default_lidar()), known(test::pose(0.2, 0, 0, 0, 0, 0), 0.05, 0.02));
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.degenerate, 1);
  EXPECT_NEAR(result.T_map_base.translation().x(), 0.2, 5e-3);
  EXPECT_NEAR(result.T_map_base.translation().y(), 0.05, 5e-3);
  EXPECT_NEAR(roll_pitch_yaw(result.T_map_base.linear()).z(), 0.01, 5e-4);
  EXPECT_NEAR(std::sqrt(result.covariance(0, 0)), 0.05, 3e-3);  // as uncertain as the prior was
  EXPECT_LT(std::sqrt(result.covariance(1, 1)), 0.02);
}

TEST(LoamRegistration, WithoutAMapOrPointsStaysAtThePriorAndDoesNotPretend) {
  LoamRegistration empty{config::LoamConfig{}, test::default_lidar().translation()};
  const PosePrior prior = known(test::pose(1, 2, 0, 0, 0, 0.3), 0.1, 0.1);
  for (const auto& points :
       {test::street().snapshot(Pose::Identity(), test::default_lidar()), std::vector<scan::LidarPoint>{}}) {
    const RegistrationResult result = empty.align(points, prior);
    EXPECT_EQ(result.overlap, 0);
    EXPECT_EQ(result.degenerate, 0x3f);
    EXPECT_LT((prior.T_map_base.inverse() * result.T_map_base).translation().norm(), 1e-9);
  }
}

TEST(LoamRegistration, ForgetsWhatIsOutsideItsWindow) {
  config::LoamConfig config;
  config.window = 30;
  LoamRegistration loam{config, test::default_lidar().translation()};
  const test::SyntheticWorld world = test::street();
  std::size_t most = 0;
  for (int i = 0; i <= 400; ++i) {  // the street again and again, further on
    const Pose T = test::pose(-25 + 0.25 * (i % 200), 0, 0, 0, 0, 0);
    const Pose shift = test::pose(50.0 * (i / 200), 0, 0, 0, 0, 0);
    loam.insert(world.snapshot(T, test::default_lidar()), shift * T);
    (void)loam.keep_around((shift * T).translation());
    if (i == 200) most = loam.size();
  }
  EXPECT_LT(loam.size(), 1.3 * static_cast<double>(most));
}

}  // namespace
}  // namespace curbstone::mapper::registration
