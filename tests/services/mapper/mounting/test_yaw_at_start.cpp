#include "services/mapper/mounting/yaw_at_start.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/services/mapper/mapper_drive.hpp"
#include "tests/services/mapper/mounting/avenue.hpp"

namespace curbstone::mapper::mounting {
namespace {

using test::kPeriod;

constexpr double kOneDegree = std::numbers::pi / 180;

/// A drive at 3 m/s in an avenue, straight or in a bend, with a LiDAR that looks aside of what its file says.
class YawAtStartTest : public ::testing::Test {
 protected:
  /// Returns what is found within `metres`, rad; and how often.
  std::optional<double> found(double yaw, double metres = 12, double bend = 0) {
    const Pose true_to_assumed = Eigen::Translation3d(at_) * Eigen::AngleAxisd(-yaw, Eigen::Vector3d::UnitZ()) *
                                 Eigen::Translation3d(-at_) * Pose::Identity();
    YawAtStart of(at_);
    std::optional<double> result;
    for (int n = 0; 3 * n * kPeriod < metres; ++n) {
      const double t = n * kPeriod, heading = bend * t;
      const double x = bend == 0 ? 3 * t : 3 / bend * std::sin(heading);
      const double y = bend == 0 ? 0 : 3 / bend * (1 - std::cos(heading));
      const Pose T_world_base = test::pose(x, y, 0, 0, 0, heading);
      auto points = world_.snapshot(T_world_base, lidar_);
      for (scan::LidarPoint& point : points)
        point.position = (true_to_assumed * point.position.cast<double>()).cast<float>();
      const auto now = of.add(test::utime(t + 1), points, T_world_base);
      times_ += now.has_value();
      if (now) result = now;
    }
    return result;
  }
  Pose lidar_ = test::default_lidar();
  Eigen::Vector3d at_ = lidar_.translation();
  test::SyntheticWorld world_ = test::avenue();
  int times_ = 0;
};

TEST_F(YawAtStartTest, ALidarThatLooksAsideIsFoundOnceWhereverItLooks) {
  for (const double degrees : {2.0, -4.0, 10.0, 90.0, -135.0, 180.0}) {
    times_ = 0;
    const auto yaw = found(degrees * kOneDegree);
    ASSERT_TRUE(yaw) << degrees;
    EXPECT_LT(std::abs(std::remainder(*yaw - degrees * kOneDegree, 2 * std::numbers::pi)), 0.5 * kOneDegree) << degrees;
    EXPECT_EQ(times_, 1);
  }
}

TEST_F(YawAtStartTest, InABendToo) {
  const auto yaw = found(4 * kOneDegree, 12, 0.2);
  ASSERT_TRUE(yaw);
  EXPECT_NEAR(*yaw, 4 * kOneDegree, 0.7 * kOneDegree);
}

TEST_F(YawAtStartTest, OneThatLooksAheadIsLeftAsItIs) {
  for (const double bend : {0.0, 0.2, -0.2}) EXPECT_FALSE(found(0, 12, bend)) << bend;
  EXPECT_FALSE(found(0.5 * kOneDegree));
}

TEST_F(YawAtStartTest, ItIsMeasuredOverTheFirstMetresOnly) {
  EXPECT_FALSE(found(4 * kOneDegree, 4)) << "two pairs of scans";
  EXPECT_TRUE(found(4 * kOneDegree, 9));
}

TEST_F(YawAtStartTest, WhereNothingStandsItIsUnknown) {
  world_ = test::plain();
  EXPECT_FALSE(found(10 * kOneDegree, 24));
}

}  // namespace
}  // namespace curbstone::mapper::mounting
