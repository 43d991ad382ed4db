#include "services/mapper/registration/icp_registration.hpp"

#include <gtest/gtest.h>

#include "common/linear/decompositions.hpp"
#include "services/mapper/registration/normal_equations.hpp"
#include "tests/services/mapper/synthetic_world.hpp"

namespace curbstone::mapper::registration {
namespace {

Matrix6 information(double sigma_m, double sigma_rad) {
  Vector6 d;
  d << Eigen::Vector3d::Constant(1 / (sigma_m * sigma_m)), Eigen::Vector3d::Constant(1 / (sigma_rad * sigma_rad));
  return d.asDiagonal();
}

double angle(const Pose& T) {
  return so3_log(Eigen::Quaterniond(T.linear())).norm();
}

/// A map of a world as a vehicle makes it that drives 3 m into it.
IcpRegistration mapped(const test::SyntheticWorld& world) {
  IcpRegistration icp{config::IcpConfig{}, test::default_lidar().translation()};
  for (int i = 0; i <= 20; ++i) {
    const Pose T = test::pose(-3 + 0.15 * i, 0, 0, 0, 0, 0);
    icp.insert(world.snapshot(T, test::default_lidar()), T);
  }
  return icp;
}

TEST(IcpRegistration, RecoversAKnownPoseInAStreet) {
  const test::SyntheticWorld world = test::street();
  IcpRegistration icp = mapped(world);
  const Pose truth = test::pose(0.1, -0.08, 0.03, 0.004, -0.006, 0.02);
  const RegistrationResult result =
      icp.align(world.snapshot(truth, test::default_lidar()), {Pose::Identity(), information(1, 0.1)});
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.degenerate, 0);
  const Pose error = truth.inverse() * result.T_map_base;
  // Planes of neighbourhoods round off corners: a millimetre, not a tenth of it.
  EXPECT_LT(error.translation().norm(), 2e-3);
  EXPECT_LT(angle(error), 2e-4);
  EXPECT_GT(result.inlier_ratio, 0.9);
  EXPECT_LT(result.residual, 0.02);
}

TEST(IcpRegistration, RecoversAKnownPoseBetweenFlatWallsExactly) {
  test::SyntheticWorld world;
  world.boxes = {{{-30, 6, -5}, {30, 8, 20}}, {{-30, -8, -5}, {30, -6, 20}}, {{12, -8, -5}, {14, 8, 20}}};
  IcpRegistration icp = mapped(world);
  const Pose truth = test::pose(0.05, -0.04, 0.01, 0.002, -0.003, 0.01);
  std::vector<scan::LidarPoint> seen = world.snapshot(truth, test::default_lidar());
  std::erase_if(seen, [&](const scan::LidarPoint& p) {  // away from the edges, where a neighbourhood is one plane
    const Eigen::Vector3d w = truth * p.position.cast<double>();
    const bool floor = std::abs(w.z()) < 1e-3 && std::abs(w.y()) < 4.5 && w.x() < 10.5;
    const bool wall = std::abs(std::abs(w.y()) - 6) < 1e-3 && w.z() > 1.5 && w.x() < 10.5;
    const bool front = std::abs(w.x() - 12) < 1e-3 && w.z() > 1.5 && std::abs(w.y()) < 4.5;
    return !(floor || wall || front);
  });
  const RegistrationResult result = icp.align(seen, {Pose::Identity(), information(10, 1)});
  EXPECT_TRUE(result.converged);
  const Pose error = truth.inverse() * result.T_map_base;
  EXPECT_LT(error.translation().norm(), 1e-4);
  EXPECT_LT(angle(error), 2e-5);
}

TEST(IcpRegistration, ItsCovarianceCoversItsErrorWithoutPretendingToKnowNothing) {
  test::SyntheticWorld world = test::street();
  world.noise = 0.02;
  IcpRegistration icp = mapped(world);
  double nees = 0;
  constexpr int kPoses = 20;
  for (int i = 0; i < kPoses; ++i) {
    const Pose truth =
        test::pose(0.05 * i - 0.5, 0.02 * (i % 5) - 0.04, 0.01 * (i % 3), 0, 0.002 * (i % 4), 0.005 * (i % 7));
    const RegistrationResult result =
        icp.align(world.snapshot(truth, test::default_lidar()), {Pose::Identity(), information(1, 0.1)});
    ASSERT_TRUE(result.converged);
    const Vector6 error = log_of(truth.inverse() * result.T_map_base);
    nees += error.dot(Ldlt<6>(result.covariance).solve(error)) / kPoses;
  }
  EXPECT_LT(nees, 6);  // as many as there are directions, were it exact
  EXPECT_GT(nees, 0.05);
}

TEST(IcpRegistration, InATunnelFollowsThePriorAlongItAndSaysSo) {
  const test::SyntheticWorld world = test::tunnel();
  IcpRegistration icp = mapped(world);
  const Pose truth = test::pose(0, 0.05, 0.02, 0, 0, 0.01);
  const PosePrior prior{test::pose(0.2, 0, 0, 0, 0, 0), information(0.05, 0.02)};
  const RegistrationResult result = icp.align(world.snapshot(truth, test::default_lidar()), prior);
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.degenerate, 1);
  EXPECT_NEAR(result.T_map_base.translation().x(), 0.2, 2e-3);
  EXPECT_NEAR(result.T_map_base.translation().y(), 0.05, 2e-3);
  EXPECT_NEAR(result.T_map_base.translation().z(), 0.02, 2e-3);
  EXPECT_NEAR(roll_pitch_yaw(result.T_map_base.linear()).z(), 0.01, 2e-4);
  EXPECT_NEAR(std::sqrt(result.covariance(0, 0)), 0.05, 2e-3);  // as uncertain as the prior was
  EXPECT_LT(std::sqrt(result.covariance(1, 1)), 0.01);
}

TEST(IcpRegistration, OnAPlainFollowsThePriorInThePlane) {
  const test::SyntheticWorld world = test::plain();
  IcpRegistration icp = mapped(world);
  const Pose truth = test::pose(0, 0, 0.03, 0.003, -0.004, 0);
  const PosePrior prior{test::pose(0.3, -0.1, 0, 0, 0, 0.05), information(0.05, 0.02)};
  const RegistrationResult result = icp.align(world.snapshot(truth, test::default_lidar()), prior);
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.degenerate, 0b100011);  // x, y, rotation about Z
  EXPECT_NEAR(result.T_map_base.translation().x(), 0.3, 2e-3);
  EXPECT_NEAR(result.T_map_base.translation().y(), -0.1, 2e-3);
  EXPECT_NEAR(result.T_map_base.translation().z(), 0.03, 2e-3);
  EXPECT_NEAR(roll_pitch_yaw(result.T_map_base.linear()).z(), 0.05, 2e-4);
}

TEST(IcpRegistration, WithoutAMapOrPointsStaysAtThePriorAndDoesNotPretend) {
  IcpRegistration empty{config::IcpConfig{}, test::default_lidar().translation()};
  const PosePrior prior{test::pose(1, 2, 0, 0, 0, 0.3), information(0.1, 0.1)};
  for (const auto& points :
       {test::street().snapshot(Pose::Identity(), test::default_lidar()), std::vector<scan::LidarPoint>{}}) {
    const RegistrationResult result = empty.align(points, prior);
    EXPECT_EQ(result.overlap, 0);
    EXPECT_EQ(result.degenerate, 0x3f);
    EXPECT_LT((prior.T_map_base.inverse() * result.T_map_base).translation().norm(), 1e-9);
  }
}

TEST(IcpRegistration, ForgetsWhatIsOutsideItsWindowAndStillWorks) {
  config::IcpConfig config;
  config.window = 30;
  IcpRegistration icp{config, test::default_lidar().translation()};
  const test::SyntheticWorld world = test::street();
  for (int i = 0; i <= 200; ++i) {
    const Pose T = test::pose(-25 + 0.25 * i, 0, 0, 0, 0, 0);
    icp.insert(world.snapshot(T, test::default_lidar()), T);
    (void)icp.keep_around(T.translation());
  }
  const Pose truth = test::pose(24.9, 0.05, 0, 0, 0, 0.01);
  const RegistrationResult result =
      icp.align(world.snapshot(truth, test::default_lidar()), {test::pose(25, 0, 0, 0, 0, 0), information(1, 0.1)});
  EXPECT_TRUE(result.converged);
  EXPECT_LT((truth.inverse() * result.T_map_base).translation().norm(), 5e-3);
}

TEST(IcpRegistration, ItsMapGrowsNoFurtherThanItsWindow) {
  config::IcpConfig config;
  config.window = 30;
  IcpRegistration icp{config, test::default_lidar().translation()};
  const test::SyntheticWorld world = test::street();
  std::size_t most = 0;
  for (int i = 0; i <= 400; ++i) {  // the street again and again, further on
    const Pose T = test::pose(-25 + 0.25 * (i % 200), 0, 0, 0, 0, 0);
    const Pose shift = test::pose(50.0 * (i / 200), 0, 0, 0, 0, 0);
    icp.insert(world.snapshot(T, test::default_lidar()), shift * T);
    (void)icp.keep_around((shift * T).translation());
    if (i == 200) most = icp.size();
  }
  EXPECT_LT(static_cast<double>(icp.size()), 1.3 * static_cast<double>(most));
}

}  // namespace
}  // namespace curbstone::mapper::registration
