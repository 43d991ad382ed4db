#include "services/localizer/search/local_scan.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/services/localizer/yard.hpp"

namespace curbstone::localizer::search {
namespace {

using test_yard::points_in;
using test_yard::pose_at;
using test_yard::Yard;

TEST(LocalScan, ShowsWhatStandsAndNotTheGround) {
  const Yard yard{.turned = 0};
  LocalScan scan;
  scan.add(points_in(yard, Pose::Identity()), pose_at(50, -20, 1.0));  // where odometry is says nothing
  const auto plan = scan.plan(pose_at(50, -20, 1.0), 30, 1000);
  EXPECT_GT(plan.size(), 60U);
  for (const Eigen::Vector2d& p : plan) {
    const double wall = std::min(std::abs(std::abs(p.x()) - 11), std::abs(std::abs(p.y()) - 7));
    const double pillar = std::min((p - Eigen::Vector2d(4, 3)).norm(), (p - Eigen::Vector2d(-6, -5)).norm());
    EXPECT_TRUE(wall < 0.3 || pillar < 0.4) << p.transpose();
  }
}

TEST(LocalScan, JoinsWhatWasSeenOnTheWay) {
  const Yard yard{.turned = 0};
  LocalScan scan;
  const Pose T_odom_yard = pose_at(3, 2, -0.4);
  for (const double x : {0.0, 1.0, 2.0}) {
    auto points = points_in(yard, pose_at(x, 0, 0));
    std::erase_if(points, [&](const Eigen::Vector3d& p) { return std::abs(p.x()) > 0.8; });  // a slice each
    scan.add(points, T_odom_yard * pose_at(x, 0, 0));
  }
  EXPECT_NEAR(scan.driven(), 2, 1e-9);
  EXPECT_EQ(scan.revolutions(), 3U);
  double first = 0, last = -10;
  for (const Eigen::Vector2d& p : scan.plan(T_odom_yard * pose_at(2, 0, 0), 30, 1000)) {
    EXPECT_NEAR(std::abs(p.y()), 7, 0.3);
    first = std::min(first, p.x());
    last = std::max(last, p.x());
  }
  EXPECT_LT(first, -2.2) << "what is 2 m behind now";
  EXPECT_LT(last, 1.0);
}

TEST(LocalScan, IsBounded) {
  LocalScan scan;
  const auto points = points_in(Yard{}, Pose::Identity());
  for (int i = 0; i < 100; ++i) scan.add(points, Pose::Identity());
  EXPECT_EQ(scan.revolutions(), LocalScan::kMaxRevolutions);
  EXPECT_EQ(scan.plan(Pose::Identity(), 30, 50).size(), 50U);
  EXPECT_TRUE(LocalScan().plan(Pose::Identity(), 30, 50).empty());
}

}  // namespace
}  // namespace curbstone::localizer::search
