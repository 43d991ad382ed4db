#include "services/mapper/tracking/scan_matcher.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/services/mapper/mapper_drive.hpp"

namespace curbstone::mapper::tracking {
namespace {

using test::MapperDrive;
constexpr int kScans = 12;

/// The street at `twist`, from a place where there is room for it.
struct MovingDrive : test::MapperDrive {
  MovingDrive(const std::string& method, const scan::Twist& twist, double x) : test::MapperDrive(method) {
    trajectory = [=](double t) { return test::pose(x, 0, 0, 0, 0, 0) * scan::move(twist, t); };
  }
};

/// The largest error of a drive without odometry; 1e9 if a scan is not placed.
double worst(test::MapperDrive& drive, int revolutions) {
  double out = 0;
  for (int i = 0; i < revolutions; ++i) {
    const auto update = drive.step();
    if (!update || !update->registered || update->fix != Fix::kTracking) return 1e9;
    out = std::max(out, drive.error(*update));
  }
  return out;
}

class OnTheMove : public testing::TestWithParam<const char*> {};

TEST_P(OnTheMove, BeginsAtAnySpeedWithoutOdometry) {
  for (const double speed : {-8.0, 0.0, 5.0, 10.0, 15.0, 20.0, 30.0}) {  // 1.5 m a scan
    MovingDrive drive(GetParam(), {{speed, 0, 0}, {0, 0, 0}}, speed > 0 ? -15 : 15);
    EXPECT_LT(worst(drive, kScans), 0.10) << speed << " m/s";
  }
}

TEST_P(OnTheMove, BeginsInABend) {
  for (const double turn : {-0.6, 0.6}) {
    MovingDrive drive(GetParam(), {{8, 0, 0}, {0, 0, turn}}, -15);
    EXPECT_LT(worst(drive, kScans), 0.10) << turn << " rad/s";
  }
}

TEST_P(OnTheMove, FindsItsWayWhenTheMotionIsAnotherAfterAGap) {
  test::MapperDrive drive(GetParam());
  drive.trajectory = [](double t) {  // four scans are lost, and while they are the vehicle begins to turn
    const double turning = std::max(t - 20 * test::kPeriod, 0.0);
    return test::pose(-10, 0, 0, 0, 0, 0) * scan::move({{6, 0, 0}, {0, 0, 0}}, std::min(t, 20 * test::kPeriod)) *
           scan::move({{6, 0, 0}, {0, 0, 0.7}}, turning);
  };
  ASSERT_LT(worst(drive, 20), 0.05);
  for (int i = 0; i < 4; ++i) (void)drive.next();
  EXPECT_LT(worst(drive, 10), 0.10);
}

TEST_P(OnTheMove, BeginsAfterAGapThatFollowsTheFirstScan) {
  test::MapperDrive drive(GetParam());
  (void)drive.step();
  for (int i = 0; i < 20; ++i) (void)drive.next();
  (void)drive.step();  // one alone may be an error
  const auto begun = drive.step();
  ASSERT_TRUE(begun);
  drive.T_world_map = drive.truth(begun->utime) * begun->T_map_base.inverse();
  EXPECT_LT(worst(drive, 10), 0.05);
}

INSTANTIATE_TEST_SUITE_P(ScanMatcher, OnTheMove, testing::Values("icp", "loam"));

TEST(ScanMatcher, TakesAVehicleToStandWhereNothingTellsHowFarAlong) {
  MovingDrive drive("icp", {{10, 0, 0}, {0, 0, 0}}, 0);
  drive.world = test::tunnel();
  (void)drive.step();
  const auto update = drive.step();
  ASSERT_TRUE(update);
  EXPECT_NE(update->registration.degenerate & 1, 0);
  EXPECT_LT(update->T_map_base.translation().norm(), 0.05);
}

TEST(ScanMatcher, LeavesOutWhatTheVehicleSeesOfItself) {
  config::MapperConfig config;
  config.vehicle.length = 4.0;
  config.vehicle.middle = 1.3;  // driven at the rear
  const Eigen::Vector3f bumper(3.2F, 0.5F, 0.4F);
  const Eigen::Vector3f follower(-1.5F, 0.5F, 0.4F);
  const Eigen::Vector3f ground(1.0F, 0.5F, 0.0F);
  scan::Scan scan;
  for (const Eigen::Vector3f& at : {bumper, follower, ground})
    scan.points.push_back({config.vehicle.T_base_lidar().inverse().cast<float>() * at});
  const auto points = ScanMatcher(config.registration, config.vehicle, 40).in_base(scan, scan::steady_sweep({}, 0.05));
  ASSERT_EQ(points.size(), 2U);
  EXPECT_TRUE(points[0].position.isApprox(follower, 1e-5F));
  EXPECT_TRUE(points[1].position.isApprox(ground, 1e-5F));
}

}  // namespace
}  // namespace curbstone::mapper::tracking
