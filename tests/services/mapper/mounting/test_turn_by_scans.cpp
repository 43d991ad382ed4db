#include "services/mapper/mounting/turn_by_scans.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "tests/services/mapper/mapper_drive.hpp"
#include "tests/services/mapper/mounting/avenue.hpp"

namespace curbstone::mapper::mounting {
namespace {

using test::kDegree;
using test::kPeriod;

/// A straight drive at 3 m/s, and odometry that turns by `false_yaw(t)`, rad, though the vehicle does not.
class TurnByScansTest : public ::testing::Test {
 protected:
  /// Returns the errors of the turn, summed up, rad.
  double sum_until(double end, const std::function<double(double)>& false_yaw) {
    Pose T_odom_base = Pose::Identity();
    double sum = 0, t_before = 0;
    for (int n = 0; n * kPeriod < end; ++n) {
      const double t = n * kPeriod;
      T_odom_base = T_odom_base * test::pose(3 * (t - t_before), 0, 0, 0, 0, false_yaw(t) - false_yaw(t_before));
      t_before = t;
      sum += turn_.error_since_last(test::utime(t + 1), world_.snapshot(test::pose(3 * t, 0, 0, 0, 0, 0), lidar_),
                                    T_odom_base);
    }
    return sum;
  }
  Pose lidar_ = test::default_lidar();
  test::SyntheticWorld world_ = test::avenue();
  TurnByScans turn_{lidar_.translation()};
};

TEST_F(TurnByScansTest, AWheelThatSlipsIsMeasured) {
  const auto slip = [](double t) { return std::clamp(t - 2.0, 0.0, 0.3) * 15 * kDegree; };
  EXPECT_NEAR(sum_until(3.5, slip), 4.5 * kDegree, 0.5 * kDegree);
}

TEST_F(TurnByScansTest, SoAreWheelsThatAreNotCalibrated) {
  EXPECT_NEAR(sum_until(4, [](double t) { return -0.5 * kDegree * t; }), -2 * kDegree, 0.4 * kDegree);
}

TEST_F(TurnByScansTest, GoodOdometryIsLeftAsItIs) {
  EXPECT_NEAR(sum_until(4, [](double) { return 0.0; }), 0, 0.4 * kDegree);
}

TEST_F(TurnByScansTest, WhereNothingStandsItIsUnknown) {
  world_ = test::plain();
  EXPECT_EQ(sum_until(2, [](double t) { return 2 * kDegree * t; }), 0);
}

/// The whole mapper in the avenue, with odometry that turns by 1 deg/s too far to the right, by a gyro that the wheels
/// confirm or not, or by no gyro.
double yaw_error_of_a_drive(bool with_gyro, bool turn_confirmed) {
  test::MapperDrive drive;
  drive.world.boxes = test::avenue().boxes;
  drive.trajectory = [](double t) { return test::pose(3 * t, 0, 0, 0, 0, 0); };
  for (double t = -0.05; t < 5; t += 0.01) {
    scan::OdometrySample sample;
    sample.utime = test::utime(t);
    sample.T_odom_base = scan::move({{3, 0, 0}, {0, 0, -kDegree}}, t);
    sample.turn_confirmed = turn_confirmed;
    sample.with_gyro = with_gyro;
    drive.odometry.add(sample);
  }
  double error = 0;
  while (drive.turn * kPeriod < 4) {
    if (const auto update = drive.step())
      error = std::abs(roll_pitch_yaw((drive.T_world_map * update->T_map_base).linear()).z());
  }
  return error;
}

TEST(TurnByScans, KeepTheMapperStraightWhereNoSurfaceDoes) {
  const double by_odometry = yaw_error_of_a_drive(true, true);
  const double by_scans = yaw_error_of_a_drive(false, false);
  std::printf("[ figure ] yaw after 4 s: %.2f deg by odometry, %.2f deg by the scans\n", by_odometry / kDegree,
              by_scans / kDegree);
  EXPECT_LT(by_scans, 1.0 * kDegree);
  EXPECT_LT(by_scans, 0.4 * by_odometry);
}

TEST(TurnByScans, CorrectAGyroThatTheWheelsContradict) {
  EXPECT_LT(yaw_error_of_a_drive(true, false), 1.0 * kDegree);
}

}  // namespace
}  // namespace curbstone::mapper::mounting
