#include "services/mapper/mounting/lidar_mounting.hpp"

#include <gmock/gmock.h>

#include "tests/services/mapper/detection_scans.hpp"

namespace curbstone::mapper::mounting {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A vehicle that drives through the street at 3 m/s, whose map fits together, as it does with any mounting: what the
/// mapper takes for base_link is where the LiDAR truly is, less vehicle.lidar.
class LidarMountingTest : public ::testing::Test {
 protected:
  LidarMountingTest() { drive_.world.boxes = {{{-500, 8, 0}, {500, 20, 9}}, {{-500, -20, 0}, {500, -9, 9}}}; }
  /// On for `seconds`; `turn` in rad/s.
  void drive(double seconds, double turn = 0) {
    const double end = t_ + seconds;
    for (; t_ < end; t_ += 0.1) {
      T_world_base_ = T_world_base_ * scan::move({{3, 0, 0}, {0, 0, turn}}, 0.1);
      const Pose T_assumed = VehicleConfig{}.T_base_lidar();
      Pose T_map_base = T_world_base_ * drive_.T_base_lidar * T_assumed.inverse();
      T_map_base.translation() *= ranges_;
      points_ = drive_.world.snapshot(T_world_base_, drive_.T_base_lidar);
      for (scan::LidarPoint& point : points_) {  // snapshot() gives true base_link
        const Eigen::Vector3d p = point.position.cast<double>();
        point.position = (T_assumed * (ranges_ * (drive_.T_base_lidar.inverse() * p))).cast<float>();
      }
      Pose T_odom_base = T_world_base_;
      T_odom_base.translation() *= odometry_scale_;
      mounting_.add({test::utime(t_), &points_, T_map_base, T_odom_base, fits_});
    }
  }
  std::string fault() const {
    std::vector<std::string> faults;
    mounting_.add_faults(faults);
    return faults.empty() ? "" : faults.front();
  }
  /// Straight on, and bends to both sides.
  void drive_round() {
    drive(16);
    for (int i = 0; i < 3; ++i) {
      drive(3, 0.35);
      drive(3, -0.35);
    }
    drive(3);
  }
  void mount(double z, double roll, double pitch, double yaw) {
    drive_.T_base_lidar = test::pose(0, 0, z, roll, pitch, yaw);
  }

  test::DetectionScans drive_;
  std::vector<scan::LidarPoint> points_;
  Pose T_world_base_ = Pose::Identity();
  double t_ = 0;
  double odometry_scale_ = 1;
  double ranges_ = 1;  // times what they should be
  bool fits_ = true;
  LidarMounting mounting_{VehicleConfig{}};
};

TEST_F(LidarMountingTest, AsTheFileSaysIsNoFault) {
  drive(30);
  drive(5, 0.3);
  drive(30);
  EXPECT_FALSE(mounting_.wrong().any()) << fault();
  EXPECT_THAT(fault(), IsEmpty());
}

TEST_F(LidarMountingTest, OneThatLeansIsReportedWithTheAnglesThatPutItRight) {
  mount(1.73, 0, 0.052, 0);  // 3 deg down
  drive(5);
  EXPECT_THAT(fault(), IsEmpty()) << "not yet";
  drive(15);
  EXPECT_TRUE(mounting_.wrong().tilt);
  EXPECT_NEAR(mounting_.lidar()[4], 0.052, 0.004);
  EXPECT_NEAR(mounting_.lidar()[2], 1.73, 0.03);
  EXPECT_THAT(fault(), HasSubstr("leans by 3.0 deg: straighten it, or set vehicle.lidar: [0.00, 0.00, 1.7"));
  EXPECT_EQ(mounting_.counters()["faults.lidar.tilted"], 1);
}

TEST_F(LidarMountingTest, RollHeightAndYawAreReportedTogether) {
  mount(1.53, 0.06, 0, -0.05);
  drive(25);
  EXPECT_NEAR(mounting_.lidar()[2], 1.53, 0.03);
  EXPECT_NEAR(mounting_.lidar()[3], 0.06, 0.006);
  EXPECT_NEAR(mounting_.lidar()[5], -0.05, 0.004);
  EXPECT_THAT(fault(), ::testing::ContainsRegex("leans by 3.. deg, looks 2.9 deg aside, is 0.20 m too low"));
}

TEST_F(LidarMountingTest, AQuarterAndHalfATurnAreReported) {
  for (const double yaw : {1.571, 3.142}) {
    mounting_ = LidarMounting(VehicleConfig{});
    mount(1.73, 0, 0, yaw);
    drive(25);
    EXPECT_TRUE(mounting_.wrong().yaw) << yaw;
    EXPECT_NEAR(std::abs(mounting_.lidar()[5]), yaw, 0.01);
  }
}

TEST_F(LidarMountingTest, OneThatSlipsOnTheWayIsReported) {
  drive(40);
  ASSERT_THAT(fault(), IsEmpty());
  mount(1.73, 0, 0.06, 0);
  mounting_.interrupt();
  drive(40);
  EXPECT_TRUE(mounting_.wrong().tilt);
  EXPECT_NEAR(mounting_.lidar()[4], 0.06, 0.006);
  mount(1.73, 0, 0, 0);
  drive(40);
  EXPECT_THAT(fault(), IsEmpty()) << "it was put right";
}

TEST_F(LidarMountingTest, UpsideDownTurnsTheOtherWay) {
  mount(1.73, 3.1416, 0, 0);
  for (int i = 0; i < 4; ++i) {
    drive(6, 0.15);
    drive(6, -0.15);
  }
  EXPECT_TRUE(mounting_.wrong().mirrored);
  EXPECT_THAT(fault(), HasSubstr("a roll of 3.1416 in vehicle.lidar"));
}

TEST_F(LidarMountingTest, OneThatIsElsewhereOnTheVehicleIsReportedAfterBends) {
  drive_.T_base_lidar = test::pose(-0.3, 0.25, 1.73, 0, 0, 0);
  mounting_.set_stamps_are_wrong(true);
  drive_round();
  EXPECT_THAT(fault(), IsEmpty()) << "late stamps may look alike";
  mounting_.set_stamps_are_wrong(false);
  drive_round();
  EXPECT_TRUE(mounting_.wrong().place);
  EXPECT_THAT(fault(), HasSubstr("is 0.30 m too far back, is 0.25 m too far to the left: straighten it, or set "
                                 "vehicle.lidar: [-0.30, 0.25, 1.7"));
  EXPECT_EQ(mounting_.counters()["faults.lidar.displaced"], 1);
}

TEST_F(LidarMountingTest, WheelsOfAnotherSizeAreReported) {
  odometry_scale_ = 1.06;
  drive(25);
  EXPECT_TRUE(mounting_.wrong().size);
  EXPECT_NEAR(mounting_.wheel_radius(), 0.17 / 1.06, 0.001);
  EXPECT_THAT(fault(),
              HasSubstr("odometry's way is 6.0 % longer than the LiDAR's: vehicle.wheel_radius is 0.160 m or less"));
}

TEST_F(LidarMountingTest, RangesThatAreSomePercentLongOrShortAreBlamedOnNeitherHeightNorWheels) {
  for (const double ranges : {1.03, 0.97, 1.06, 0.9, 1.12}) {
    mounting_ = LidarMounting(VehicleConfig{});
    ranges_ = ranges;
    drive(25);
    EXPECT_TRUE(mounting_.wrong().ranges) << ranges;
    EXPECT_FALSE(mounting_.wrong().height || mounting_.wrong().size) << ranges;
    EXPECT_THAT(fault(), HasSubstr(ranges > 1 ? "too long, by the ground" : "too short, by the ground")) << ranges;
    EXPECT_EQ(mounting_.counters()["faults.lidar.ranges"], 1);
    EXPECT_EQ(mounting_.counters()["faults.wheels.size"], 0);
  }
}

TEST_F(LidarMountingTest, AnotherHeightOrOtherWheelsAloneAreNotRanges) {
  mount(1.83, 0, 0, 0);
  drive(25);
  EXPECT_FALSE(mounting_.wrong().ranges);
  mounting_ = LidarMounting(VehicleConfig{});
  mount(1.73, 0, 0, 0);
  odometry_scale_ = 0.96;
  drive(25);
  EXPECT_FALSE(mounting_.wrong().ranges);
}

TEST_F(LidarMountingTest, WhatOnlyOdometryTellsSaysNothingOfTheWheels) {
  odometry_scale_ = 1.06;
  fits_ = false;
  drive(40);
  EXPECT_FALSE(mounting_.wrong().any());
}

TEST_F(LidarMountingTest, ACarAheadAndKerbsAreNotTheGround) {
  drive_.world.boxes.push_back({{-500, 1.2, 0}, {500, 8, 0.15}});
  const double start = 6;
  for (int i = 0; i < 400; ++i) {
    drive_.world.boxes.push_back({{T_world_base_.translation().x() + start, -0.9, 0.3},
                                  {T_world_base_.translation().x() + start + 4, 0.9, 1.5}});
    drive(0.1);
    drive_.world.boxes.pop_back();
  }
  EXPECT_THAT(fault(), IsEmpty());
}

TEST_F(LidarMountingTest, AStandingVehicleSaysNothing) {
  mount(1.73, 0, 0.1, 0);
  drive(0.2);
  for (int i = 0; i < 500; ++i, t_ += 0.1)
    mounting_.add({test::utime(t_), &points_, T_world_base_, T_world_base_, true});
  EXPECT_THAT(fault(), IsEmpty());
}

}  // namespace
}  // namespace curbstone::mapper::mounting
