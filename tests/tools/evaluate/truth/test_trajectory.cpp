#include "tools/evaluate/truth/trajectory.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace curbstone::evaluate::truth {
namespace {

Pose pose(double x, double y, double yaw) {
  Pose p = Pose::Identity();
  p.translation() = Eigen::Vector3d(x, y, 0);
  p.linear() = rotation_from_rpy(0, 0, yaw);
  return p;
}

/// A quarter circle of 100 m radius, a pose each 0.1 m.
std::vector<Pose> arc(double scale = 1.0) {
  std::vector<Pose> poses;
  for (int i = 0; i < 1570; ++i) {
    const double a = i * 0.001;
    poses.push_back(pose(scale * 100 * std::sin(a), scale * 100 * (1 - std::cos(a)), a));
  }
  return poses;
}

TEST(Trajectory, InterpolatesBetweenPosesAndNotBeyondThem) {
  const Trajectory path = {{1000, pose(0, 0, 0)}, {2000, pose(1, 0, 0)}, {900'000, pose(2, 0, 0)}};
  ASSERT_TRUE(pose_at(path, 1500));
  EXPECT_NEAR(pose_at(path, 1500)->translation().x(), 0.5, 1e-12);
  EXPECT_FALSE(pose_at(path, 999));
  EXPECT_FALSE(pose_at(path, 900'001));
  EXPECT_FALSE(pose_at(path, 400'000)) << "across a gap";
}

TEST(Trajectory, AlignmentFindsTheRigidTransform) {
  const Pose T = pose(5, -3, 2.0);
  PosePairs pairs;
  for (const Pose& p : arc()) {
    pairs.truth.push_back(T * p);
    pairs.estimate.push_back(p);
  }
  EXPECT_TRUE(align(pairs).isApprox(T, 1e-9));
  EXPECT_NEAR(trajectory_errors(pairs).ate_m, 0, 1e-9);
}

TEST(Trajectory, AStraightPathIsAlignedInRollToo) {
  const Pose T = pose(1, 2, 0.3);
  PosePairs pairs;
  for (int i = 0; i < 100; ++i) {
    pairs.estimate.push_back(pose(i, 0, 0));
    pairs.truth.push_back(T * pairs.estimate.back());
  }
  EXPECT_TRUE(align(pairs).isApprox(T, 1e-9));
}

TEST(Trajectory, AScaleErrorOfOnePercentIsOnePercent) {
  PosePairs pairs{arc(), arc(1.01)};
  const TrajectoryErrors errors = trajectory_errors(pairs);
  EXPECT_NEAR(errors.distance_m, 157, 0.2);
  EXPECT_NEAR(errors.rpe_percent, 1.0, 0.02);
  EXPECT_NEAR(errors.rpe_deg_per_m, 0, 1e-9);
  EXPECT_GT(errors.end_percent, 0.8);
}

TEST(Trajectory, StandingStillIsNoDistance) {
  PosePairs pairs;
  for (int i = 0; i < 1000; ++i) {
    pairs.truth.push_back(pose(1e-4 * (i % 3), 0, 0));
    pairs.estimate.push_back(pose(0, 0, 0));
  }
  EXPECT_LT(trajectory_errors(pairs).distance_m, 0.001);
}

}  // namespace
}  // namespace curbstone::evaluate::truth
