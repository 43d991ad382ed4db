#include "services/mapper/scan/pose_pairs.hpp"

#include <gtest/gtest.h>

#include "tests/services/mapper/synthetic_world.hpp"
#include "tests/stamps.hpp"

namespace curbstone::mapper::scan {
namespace {

using test::kStart;

/// Yaw and pitch of registration and odometry, rad.
void add(PosePairs& pairs, int i, double map_yaw, double odom_yaw, double map_pitch = 0) {
  pairs.add(kStart + 50'000 * i, test::pose(3, 0, 0, 0, map_pitch, map_yaw), test::pose(0, 0, 0, 0, 0, odom_yaw));
}

TEST(PosePairs, TellHowMuchFartherTheMapTurnedAboutEachAxis) {
  PosePairs pairs;
  add(pairs, 0, 1.0, 0.2);
  const Eigen::Vector3d apart = pairs.turned_apart(test::pose(3, 0, 0, 0, 0, 1.3), test::pose(0, 0, 0, 0, 0, 0.4));
  EXPECT_TRUE(apart.isApprox(Eigen::Vector3d(0, 0, 0.1), 1e-9)) << apart.transpose();
  const Eigen::Vector3d nods = pairs.turned_apart(test::pose(3, 0, 0, 0, 0.02, 1.0), test::pose(0, 0, 0, 0, 0, 0.2));
  EXPECT_TRUE(nods.isApprox(Eigen::Vector3d(0, 0.02, 0), 1e-9)) << nods.transpose();
}

TEST(PosePairs, CompareWithASecondAgo) {
  PosePairs pairs;
  for (int i = 0; i <= 60; ++i) add(pairs, i, 0.01 * i, 0);
  EXPECT_EQ(pairs.newest(), kStart + 3'000'000);
  const double apart = pairs.turned_apart(test::pose(3, 0, 0, 0, 0, 0.6), Pose::Identity()).z();
  EXPECT_NEAR(apart, 0.2, 1e-9) << "20 revolutions of 0.01 rad";
}

TEST(PosePairs, GoOnByOdometryFromTheOldest) {
  PosePairs pairs;
  add(pairs, 0, 1.0, 0.2);
  add(pairs, 1, 5.0, 0.2);
  const Pose T_odom_base = test::pose(0, 0, 0, 0, 0, 0.2) * test::pose(1, 0, 0, 0, 0, 0.1);
  EXPECT_TRUE(pairs.by_odometry(T_odom_base).isApprox(test::pose(3, 0, 0, 0, 0, 1) * test::pose(1, 0, 0, 0, 0, 0.1)));
}

TEST(PosePairs, BeginAnewWhenTheClockIsSetBack) {
  PosePairs pairs;
  EXPECT_TRUE(pairs.empty());
  add(pairs, 10, 1, 0);
  add(pairs, 5, 2, 0);
  EXPECT_NEAR(pairs.turned_apart(test::pose(3, 0, 0, 0, 0, 2), Pose::Identity()).z(), 0, 1e-9);
  pairs.clear();
  EXPECT_TRUE(pairs.empty());
}

}  // namespace
}  // namespace curbstone::mapper::scan
