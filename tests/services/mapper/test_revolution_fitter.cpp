#include "services/mapper/revolution_fitter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/services/mapper/mapper_drive.hpp"

namespace curbstone {
namespace {

using test::MapperDrive;
constexpr int kRevolutions = 12;

/// The street at `twist`, from a place where there is room for it.
struct MovingDrive : MapperDrive {
  MovingDrive(const std::string& method, const Twist& twist, double x) : MapperDrive(method) {
    trajectory = [=](double t) { return test::pose(x, 0, 0, 0, 0, 0) * move(twist, t); };
  }
};

/// The largest error of a drive without odometry; 1e9 if a revolution is not placed.
double worst(MapperDrive& drive, int revolutions) {
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
  for (const double speed : {-8.0, 0.0, 5.0, 10.0, 15.0, 20.0, 30.0}) {  // 1.5 m a revolution
    MovingDrive drive(GetParam(), {{speed, 0, 0}, {0, 0, 0}}, speed > 0 ? -15 : 15);
    EXPECT_LT(worst(drive, kRevolutions), 0.10) << speed << " m/s";
  }
}

TEST_P(OnTheMove, BeginsInABend) {
  for (const double turn : {-0.6, 0.6}) {
    MovingDrive drive(GetParam(), {{8, 0, 0}, {0, 0, turn}}, -15);
    EXPECT_LT(worst(drive, kRevolutions), 0.10) << turn << " rad/s";
  }
}

TEST_P(OnTheMove, FindsItsWayWhenTheMotionIsAnotherAfterAGap) {
  MapperDrive drive(GetParam());
  drive.trajectory = [](double t) {  // four revolutions are lost, and while they are the vehicle begins to turn
    const double turning = std::max(t - 20 * test::kPeriod, 0.0);
    return test::pose(-10, 0, 0, 0, 0, 0) * move({{6, 0, 0}, {0, 0, 0}}, std::min(t, 20 * test::kPeriod)) *
           move({{6, 0, 0}, {0, 0, 0.7}}, turning);
  };
  ASSERT_LT(worst(drive, 20), 0.05);
  for (int i = 0; i < 4; ++i) (void)drive.next();
  EXPECT_LT(worst(drive, 10), 0.10);
}

TEST_P(OnTheMove, BeginsAfterAGapThatFollowsTheFirstRevolution) {
  MapperDrive drive(GetParam());
  (void)drive.step();
  for (int i = 0; i < 20; ++i) (void)drive.next();
  (void)drive.step();  // one alone may be an error
  const auto begun = drive.step();
  ASSERT_TRUE(begun);
  drive.T_world_map = drive.truth(begun->utime) * begun->T_map_base.inverse();
  EXPECT_LT(worst(drive, 10), 0.05);
}

INSTANTIATE_TEST_SUITE_P(RevolutionFitter, OnTheMove, testing::Values("icp", "loam"));

TEST(RevolutionFitter, TakesAVehicleToStandWhereNothingTellsHowFarAlong) {
  MovingDrive drive("icp", {{10, 0, 0}, {0, 0, 0}}, 0);
  drive.world = test::tunnel();
  (void)drive.step();
  const auto update = drive.step();
  ASSERT_TRUE(update);
  EXPECT_NE(update->registration.degenerate & 1, 0);
  EXPECT_LT(update->T_map_base.translation().norm(), 0.05);
}

TEST(RevolutionFitter, LeavesOutWhatTheVehicleSeesOfItself) {
  MapperConfig config;
  config.vehicle.length = 4.0;
  config.vehicle.middle = 1.3;  // driven at the rear
  const Eigen::Vector3f bumper(3.2F, 0.5F, 0.4F);
  const Eigen::Vector3f follower(-1.5F, 0.5F, 0.4F);
  const Eigen::Vector3f ground(1.0F, 0.5F, 0.0F);
  Revolution revolution;
  for (const Eigen::Vector3f& at : {bumper, follower, ground})
    revolution.points.push_back({config.vehicle.T_base_lidar().inverse().cast<float>() * at});
  const auto points = RevolutionFitter(config).in_base(revolution, steady_sweep({}, 0.05));
  ASSERT_EQ(points.size(), 2U);
  EXPECT_TRUE(points[0].position.isApprox(follower, 1e-5F));
  EXPECT_TRUE(points[1].position.isApprox(ground, 1e-5F));
}

}  // namespace
}  // namespace curbstone
