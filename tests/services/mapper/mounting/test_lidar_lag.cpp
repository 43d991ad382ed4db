#include "services/mapper/mounting/lidar_lag.hpp"

#include <gmock/gmock.h>

#include <functional>

#include "tests/services/mapper/detection_scans.hpp"

namespace curbstone::mapper::mounting {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A vehicle at 3 m/s that turns by 90 deg to the left and to the right in turn, with 6 s between, registered twenty
/// times a second to half a milliradian.
class LidarLagTest : public ::testing::Test {
 protected:
  static double corners(double t) {
    constexpr double kTurn = 1.5707963267948966;
    const double in_turn = std::fmod(t, 12.0);
    const double turned = in_turn < 6 ? 0 : kTurn * 0.5 * (1 - std::cos(3.14159265358979 * (in_turn - 6) / 6));
    return std::fmod(t, 24.0) < 12 ? turned : kTurn - turned;
  }
  void drive(double seconds, const std::function<double(double)>& yaw = corners) {
    for (double end = t_ + seconds; t_ < end; t_ += 0.05) {
      const double noise = 0.001 * (test::chance(n_++) - 0.5);
      const Pose T_map_base = test::pose(5, 3, 0, 0, 0, 1 + yaw(t_ - lag_) + noise);
      lidar_.add(test::utime(t_), T_map_base, test::pose(0, 0, 0, 0, 0, gyro_scale_ * yaw(t_) + gyro_bias_ * t_));
    }
  }
  std::vector<std::string> faults() const {
    std::vector<std::string> faults;
    lidar_.add_faults(faults);
    return faults;
  }
  double t_ = 0;
  std::uint64_t n_ = 0;
  double lag_ = 0, gyro_scale_ = 1, gyro_bias_ = 0;  // s; rad/s
  LidarLag lidar_;
};

TEST_F(LidarLagTest, StampsThatAreRightAreNoFault) {
  drive(90);
  ASSERT_TRUE(lidar_.lag());
  EXPECT_NEAR(*lidar_.lag(), 0, 0.004);
  EXPECT_THAT(faults(), IsEmpty());
  EXPECT_EQ(lidar_.counters()["faults.lidar.late"], 0);
}

TEST_F(LidarLagTest, LateAndEarlyStampsAreMeasuredAndReported) {
  for (const double lag : {0.3, 0.1, 0.055, -0.055, -0.1, -0.3}) {
    lidar_ = LidarLag();
    lag_ = lag;
    drive(60);
    ASSERT_TRUE(lidar_.lag()) << lag;
    EXPECT_NEAR(*lidar_.lag(), lag, 0.004) << lag;
    EXPECT_NEAR(static_cast<double>(lidar_.counters()["lidar.lag_ms"]), 1000 * lag, 4) << lag;
    EXPECT_TRUE(lidar_.wrong()) << lag;
  }
  EXPECT_EQ(lidar_.counters()["faults.lidar.late"], 1);
  EXPECT_THAT(faults().front(), ::testing::ContainsRegex("stamps are (29|30). ms early against those of odometry"));
  EXPECT_THAT(faults().front(), ::testing::ContainsRegex("set lidar.time_offset 0.(29|30). s higher than it is"));
}

TEST_F(LidarLagTest, TwentyMillisecondsAreNoFault) {
  lag_ = 0.02;
  drive(60);
  EXPECT_EQ(lidar_.counters()["lidar.lag_ms"] / 5, 4);
  EXPECT_THAT(faults(), IsEmpty());
}

TEST_F(LidarLagTest, AGyroWithAWrongScaleAndRateIsNoLag) {
  gyro_scale_ = 1.05;
  gyro_bias_ = 0.01;
  drive(90);
  ASSERT_TRUE(lidar_.lag());
  EXPECT_NEAR(*lidar_.lag(), 0, 0.004);
}

TEST_F(LidarLagTest, AVehicleThatDrivesStraightOnOrStandsTellsNothing) {
  lag_ = 0.3;
  drive(300, [](double t) { return 0.0002 * t; });
  drive(300, [](double) { return 0.06; });
  EXPECT_FALSE(lidar_.lag());
  EXPECT_THAT(faults(), IsEmpty());
}

TEST_F(LidarLagTest, ASlowWeaveTellsNothingThatIsNotSure) {
  lag_ = 0.3;
  drive(300, [](double t) { return 0.01 * std::sin(0.1 * t); });
  if (lidar_.lag()) {
    EXPECT_NEAR(*lidar_.lag(), lag_, 0.03);
  }
}

TEST_F(LidarLagTest, OneThatIsPutRightIsReportedNoMore) {
  lag_ = 0.1;
  drive(60);
  ASSERT_EQ(faults().size(), 1U);
  lag_ = 0;
  drive(180);
  EXPECT_THAT(faults(), IsEmpty());
  EXPECT_NEAR(static_cast<double>(lidar_.counters()["lidar.lag_ms"]), 0, 4);
}

TEST_F(LidarLagTest, WhatIsFarOffOrHasNothingToDoWithTheTurnsIsNotSaid) {
  lag_ = 2;
  drive(120);
  EXPECT_FALSE(lidar_.lag());
  lidar_ = LidarLag();
  for (double end = t_ + 120; t_ < end; t_ += 0.05)  // each turns by itself
    lidar_.add(test::utime(t_), test::pose(0, 0, 0, 0, 0, 0.3 * std::sin(0.9 * t_)),
               test::pose(0, 0, 0, 0, 0, 0.3 * std::sin(0.53 * t_)));
  EXPECT_THAT(faults(), IsEmpty());
}

TEST_F(LidarLagTest, AnotherMapAndAClockThatLeapsAreNoTurn) {
  for (int i = 0; i < 30; ++i) {
    drive(3);
    if (i % 2 == 0)
      t_ += 3600.0 * (i % 4 == 0 ? 1 : -1) + 0.5;
    else
      lidar_.interrupt();
  }
  EXPECT_THAT(faults(), IsEmpty());
}

}  // namespace
}  // namespace curbstone::mapper::mounting
