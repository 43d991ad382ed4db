#include "services/mapper/mounting/yaw_at_start.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <string>

#include "services/mapper/scan/deskew.hpp"
#include "tests/paths.hpp"
#include "tests/services/mapper/mapper_drive.hpp"
#include "tests/services/mapper/mounting/avenue.hpp"
#include "tools/bench/mapping/drives/scan_drive.hpp"

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

/// A recorded street, begun at several places of it; odometry is the recording's reference.
TEST(YawAtStart, IsRightInARecordedStreet) {
  const std::string folder = test::data_path("kitti0005_rs16");
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not there";
  const bench::mapping::drives::ScanDrive drive(folder, folder + "/reference_poses.txt", folder + "/times.txt");
  const evaluate::truth::Trajectory& truth = drive.truth();
  const Pose T_base_lidar = test::default_lidar();
  const auto found_from = [&](std::size_t begin, double yaw) {
    const Pose turn = test::pose(0, 0, 0, 0, 0, -yaw);  // the LiDAR is above base_link
    YawAtStart of(T_base_lidar.translation());
    std::optional<double> found;
    for (std::size_t i = begin; i + 1 < truth.size() && !found; ++i) {
      const double stride = 1e-6 * static_cast<double>(truth[i + 1].utime - truth[i].utime);
      const scan::Twist twist = scan::twist_of(truth[i].pose.inverse() * truth[i + 1].pose, stride);
      const scan::Scan scan = drive.scan(i);
      const double sweep = 1e-6 * static_cast<double>(scan.end - scan.start);
      auto points = scan::deskew(scan.points, Pose::Identity(), scan::steady_sweep(twist, sweep));
      for (scan::LidarPoint& point : points)
        point.position = (turn * T_base_lidar * point.position.cast<double>()).cast<float>();
      const Pose T_odom_lidar = truth[i].pose * scan::move(twist, 0.5 * sweep);
      found = of.add(scan.end, points, T_base_lidar * T_odom_lidar * T_base_lidar.inverse());
    }
    return found;
  };
  for (std::size_t begin = 0; begin < 120; begin += 15) {
    EXPECT_FALSE(found_from(begin, 0)) << begin;
    for (const double degrees : {4.0, -10.0, 180.0}) {
      const auto yaw = found_from(begin, degrees * kOneDegree);
      ASSERT_TRUE(yaw) << begin << ' ' << degrees;
      const double off = std::remainder(*yaw - degrees * kOneDegree, 2 * std::numbers::pi);
      std::printf("[ figure ] from scan %zu: %.1f deg is found as %.2f deg more\n", begin, degrees, off / kOneDegree);
      EXPECT_LT(std::abs(off), kOneDegree) << begin << ' ' << degrees;
    }
  }
}

}  // namespace
}  // namespace curbstone::mapper::mounting
