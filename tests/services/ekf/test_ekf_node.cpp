#include "services/ekf/ekf_node.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <initializer_list>
#include <random>
#include <thread>

#include "tests/services/ekf/ekf_node_test.hpp"
#include "tests/services/ekf/late_stamps.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::ekf {
namespace {

constexpr std::int64_t kHour = 3'600'000'000;  // us

TEST_F(EkfNodeTest, PublishesOneOdometryAndOnePoseForEveryImuSample) {
  Rig rig(config_);
  for (std::size_t i = 0; i < drive_.imu.size(); ++i) send(rig, i);
  rig.finish();
  ASSERT_FALSE(rig.odometry.empty());
  const std::size_t first = drive_.index_of(rig.odometry.front().utime);
  EXPECT_NEAR(base::seconds_between(drive_.imu.front().utime, rig.odometry.front().utime), config_.start.still, 0.02);
  ASSERT_EQ(rig.odometry.size(), drive_.imu.size() - first);
  ASSERT_EQ(rig.poses.size(), rig.odometry.size());
  for (std::size_t i = 0; i < rig.odometry.size(); ++i) {
    EXPECT_EQ(rig.odometry[i].utime, drive_.imu[first + i].utime);
    EXPECT_EQ(rig.poses[i].utime, rig.odometry[i].utime);
    EXPECT_TRUE(rig.odometry[i].flags & odometry_t::INITIALISED);
  }
  EXPECT_TRUE(rig.node.report().faults.empty());
}

TEST_F(EkfNodeTest, StartsAtTheOriginWithYawZeroAndLevelled) {
  Rig rig(config_);
  for (std::size_t i = 0; i < 300; ++i) send(rig, i);
  const odometry_t& m = rig.odometry.front();
  const Pose T_odom_base = pose_from_arrays(m.position, m.orientation);
  const Eigen::Vector3d rpy = roll_pitch_yaw(T_odom_base.linear());
  const Eigen::Vector3d truth = roll_pitch_yaw(drive_.truth[100].T_world_base.linear());
  EXPECT_LT(T_odom_base.translation().norm(), 1e-9);
  EXPECT_NEAR(rpy.z(), 0.0, 1e-9);
  EXPECT_NEAR(rpy.x(), truth.x(), 0.01);  // 0.04 m/s^2 of bias are 0.004 rad
  EXPECT_NEAR(rpy.y(), truth.y(), 0.01);
}

TEST_F(EkfNodeTest, PoseIsInTheLocalFrameAndOdometryInTheBody) {
  Rig rig(config_);
  for (std::size_t i = 0; i < drive_.imu.size(); ++i) send(rig, i);
  const odometry_t& odometry = rig.odometry.back();
  const pose_t& pose = rig.poses.back();
  const Eigen::Quaterniond q(pose.orientation[0], pose.orientation[1], pose.orientation[2], pose.orientation[3]);
  const Eigen::Vector3d body(odometry.velocity);
  ASSERT_GT(body.x(), 2.0);
  EXPECT_LT((q * body - Eigen::Vector3d(pose.vel)).norm(), 1e-9);
  EXPECT_LT((q * Eigen::Vector3d(odometry.angular_rate) - Eigen::Vector3d(pose.rotation_rate)).norm(), 1e-9);
  EXPECT_LT(Eigen::Vector3d(pose.accel).norm(), 3.0);  // without gravity
}

TEST_F(EkfNodeTest, ItsOutputIsTheSameBitForBitHoweverTheChannelsInterleave) {
  Rig in_order(config_);
  for (std::size_t i = 0; i < drive_.imu.size(); ++i) send(in_order, i);
  in_order.finish();
  for (unsigned seed = 1; seed <= 5; ++seed) {
    // Either channel may run ahead of the other by up to 150 ms.
    std::mt19937 random(seed);
    Rig mixed(config_);
    std::size_t imu = 0;
    std::size_t wheels = 0;
    while (imu < drive_.imu.size() || wheels < drive_.wheels.size()) {
      const bool imu_may = imu < drive_.imu.size() && (wheels == drive_.wheels.size() || imu < wheels + 15);
      const bool wheels_may = wheels < drive_.wheels.size() && (imu == drive_.imu.size() || wheels < imu + 15);
      const bool take_imu = imu_may && (!wheels_may || random() % 8 < (random() % 2 ? 1 : 7));
      if (take_imu)
        mixed.send("IMU", message_of(drive_.imu[imu], static_cast<std::int32_t>(imu))), ++imu;
      else
        mixed.send("WHEELS", message_of(drive_.wheels[wheels], static_cast<std::int32_t>(wheels))), ++wheels;
      mixed.node.tick(static_cast<std::int64_t>(random()));
    }
    mixed.finish();
    EXPECT_EQ(mixed.node.report().counters["dropped.late"], 0);
    EXPECT_TRUE(mixed.bytes == in_order.bytes) << "seed " << seed;
  }
}

TEST_F(EkfNodeTest, SaysWhichSensorIsSilentAndThatItRecovered) {
  Rig rig(config_);
  for (std::size_t i = 0; i < 500; ++i) send(rig, i);
  EXPECT_TRUE(rig.node.report().faults.empty());
  for (std::size_t i = 500; i < 700; ++i) {
    rig.send("WHEELS", message_of(drive_.wheels[i], static_cast<std::int32_t>(i)));
    rig.node.tick(drive_.wheels[i].utime);
  }
  EXPECT_THAT(rig.node.report().faults, ::testing::Contains(::testing::HasSubstr("IMU: silent for")));
  EXPECT_THAT(rig.node.report().faults, ::testing::Contains(::testing::HasSubstr("coasts on the wheels")));
  EXPECT_TRUE(rig.odometry.back().flags & odometry_t::NO_IMU);
  for (std::size_t i = 700; i < 900; ++i) send(rig, i);
  EXPECT_TRUE(rig.node.report().faults.empty());
  for (std::size_t i = 900; i < 1100; ++i) {
    rig.send("IMU", message_of(drive_.imu[i], static_cast<std::int32_t>(i)));
    rig.node.tick(drive_.imu[i].utime);
  }
  EXPECT_THAT(rig.node.report().faults, ::testing::Contains(::testing::HasSubstr("WHEELS: silent for")));
  EXPECT_TRUE(rig.odometry.back().flags & odometry_t::NO_WHEELS);
  for (std::size_t i = 1100; i < 1300; ++i) send(rig, i);
  EXPECT_TRUE(rig.node.report().faults.empty());
  EXPECT_FALSE(rig.odometry.back().flags & odometry_t::NO_IMU);
  EXPECT_FALSE(rig.odometry.back().flags & odometry_t::NO_WHEELS);
  const NodeReport report = rig.node.report();
  EXPECT_EQ(report.counters["lost.imu"], 200);
  EXPECT_EQ(report.counters["lost.wheels"], 200);
}

TEST_F(EkfNodeTest, SaysThatItHeardNothing) {
  Rig rig(config_);
  std::int64_t now = 1'700'000'000'000'000;
  rig.node.tick(now);
  EXPECT_TRUE(rig.node.report().faults.empty()) << "the drivers may be starting as well";
  for (int i = 0; i < 105; ++i) rig.node.tick(now += 20'000);
  const std::vector<std::string> faults = rig.node.report().faults;
  EXPECT_THAT(faults, ::testing::Contains("IMU: nothing heard yet"));
  EXPECT_THAT(faults, ::testing::Contains("WHEELS: nothing heard yet"));
  EXPECT_THAT(faults, ::testing::Contains(::testing::HasSubstr("no odometry yet")));
}

TEST_F(EkfNodeTest, DoesNotBlameTheSensorsWhenItWasStoppedItself) {
  Rig rig(config_);
  for (std::size_t i = 0; i < 500; ++i) {
    send(rig, i);
    rig.node.tick(drive_.imu[i].utime);
  }
  std::int64_t now = drive_.imu[500].utime + 5'000'000;
  rig.node.tick(now);
  EXPECT_TRUE(rig.node.report().faults.empty()) << "what they said meanwhile waits to be handled";
  for (int i = 0; i < 40; ++i) rig.node.tick(now += 20'000);
  EXPECT_THAT(rig.node.report().faults, ::testing::Contains(::testing::HasSubstr("IMU: silent for 1.3 s")))
      << "since the wake-up";
}

TEST_F(EkfNodeTest, ANodeThatWasKilledIsGoneOnWith) {
  test::TemporaryFolder folder;
  config_.state_file = folder / "ekf.state";
  {
    Rig killed(config_);
    for (std::size_t i = 0; i < 600; ++i) {
      send(killed, i);
      killed.node.tick(drive_.imu[i].utime);
    }
  }
  Rig next(config_);
  for (std::size_t i = 640; i < 900; ++i) send(next, i);
  EXPECT_EQ(next.node.report().counters["starts.inherited"], 1);
  ASSERT_FALSE(next.odometry.empty());
  EXPECT_TRUE(next.odometry.back().flags & odometry_t::INITIALISED);
}

TEST_F(EkfNodeTest, AStateFileThatCannotBeWrittenIsAFault) {
  config_.state_file = "/no/such/folder/ekf.state";
  Rig rig(config_);
  for (std::size_t i = 0; i < 300; ++i) {
    send(rig, i);
    rig.node.tick(drive_.imu[i].utime);
  }
  for (int i = 0; i < 6000 && rig.node.report().counters["faults.state_file"] == 0; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_GT(rig.node.report().counters["faults.state_file"], 0);
  ASSERT_FALSE(rig.node.report().faults.empty());
  EXPECT_NE(rig.node.report().faults.back().find("/no/such/folder"), std::string::npos);
}

TEST_F(EkfNodeTest, SaysWhichWheelIsWrongAndHow) {
  Rig rig(config_);
  for (std::size_t i = 0; i < drive_.imu.size(); ++i) {
    base::WheelSample wheels = drive_.wheels[i];
    if (i > 800) wheels.angle[1] = drive_.wheels[800].angle[1] + 2 * (wheels.angle[1] - drive_.wheels[800].angle[1]);
    rig.send("WHEELS", message_of(wheels, static_cast<std::int32_t>(i)));
    rig.send("IMU", message_of(drive_.imu[i], static_cast<std::int32_t>(i)));
  }
  const NodeReport report = rig.node.report();
  EXPECT_EQ(report.counters["faults.wheel_right"], 1);
  EXPECT_GT(report.counters["withheld.wheel_right"], 100);
  EXPECT_EQ(report.counters["withheld.wheel_left"], 0);
  ASSERT_EQ(report.faults.size(), 1U);
  EXPECT_NE(report.faults[0].find("the right wheel is wrong for long (turns at 2.0"), std::string::npos)
      << report.faults[0];
}

TEST_F(EkfNodeTest, SaysWhichAxisOfTheGyroIsStuckAndThatItLives) {
  Rig rig(config_);
  for (std::size_t i = 0; i < 1500; ++i) {
    if (i >= 800 && i < 1000) drive_.imu[i].angular_rate.z() = 0.0203;
    send(rig, i);
    if (i != 900) continue;
    EXPECT_THAT(rig.node.report().faults,
                ::testing::ElementsAre(::testing::HasSubstr("the gyro's z axis is stuck at 0.0203 rad/s"),
                                       ::testing::HasSubstr("the wheels tell how it turns")));
  }
  const NodeReport report = rig.node.report();
  EXPECT_TRUE(report.faults.empty());
  EXPECT_EQ(report.counters["faults.gyro_z"], 1);
  EXPECT_EQ(report.counters["trusted.gyro_z"], 1);
}

TEST_F(EkfNodeTest, PassesOnTheDrivesFaults) {
  Rig rig(config_);
  for (std::size_t i = 0; i < 200; ++i) send(rig, i);
  wheels_t m = message_of(drive_.wheels[200], 200);
  m.faults[1] = 0x2310;
  rig.send("WHEELS", m);
  EXPECT_THAT(rig.node.report().faults, ::testing::ElementsAre("WHEELS: right drive reports fault 0x2310"));
}

TEST_F(EkfNodeTest, LateStampsOfTheImuAreStraightenedAndRegularOnesKept) {
  Rig rig(config_);
  for (std::size_t i = 0; i < drive_.imu.size(); ++i) send(rig, i);
  rig.finish();
  EXPECT_EQ(rig.node.report().counters["straightened.imu"], 0);
  const std::vector<base::ImuSample> taken = drive_.imu;
  make_late(drive_.imu, 0.02, 1);
  Rig late(config_);
  for (std::size_t i = 0; i < drive_.imu.size(); ++i) send(late, i);
  late.finish();
  EXPECT_GT(late.node.report().counters["straightened.imu"], 1000);
  EXPECT_NEAR(static_cast<double>(late.odometry.back().utime), static_cast<double>(taken.back().utime), 2e3);
}

/// Half a second at 3 m/s was 1.5 m, and a turn. What is said is as if nothing had been, with stamps of the new clock.
TEST_F(EkfNodeTest, AClockThatIsSetMovesNothing) {
  Rig good(config_);
  for (std::size_t i = 0; i < drive_.imu.size(); ++i) send(good, i);
  good.finish();
  for (const std::int64_t step :
       std::initializer_list<std::int64_t>{-kHour, -2'000'000, -900'000, -500'000, -150'000, 150'000, 500'000, 900'000,
                                           2'000'000, kHour, 70'000 * kHour}) {
    Rig rig(config_);
    for (std::size_t i = 0; i < drive_.imu.size(); ++i) {
      base::WheelSample wheels = drive_.wheels[i];
      base::ImuSample imu = drive_.imu[i];
      if (i >= 1000) imu.utime += step;
      if (i >= (step < 0 ? 998 : 1002)) wheels.utime += step;
      rig.send("WHEELS", message_of(wheels, static_cast<std::int32_t>(i)));
      rig.send("IMU", message_of(imu, static_cast<std::int32_t>(i)));
    }
    rig.finish();
    ASSERT_NEAR(static_cast<double>(rig.odometry.size()), static_cast<double>(good.odometry.size()), 2) << step;
    const odometry_t& end = rig.odometry.back();
    const odometry_t& expected = good.odometry.back();
    EXPECT_NEAR(static_cast<double>(end.utime), static_cast<double>(expected.utime + step), 1'000);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(end.position[k], expected.position[k], 0.01) << step;
    for (int k = 0; k < 4; ++k) EXPECT_NEAR(end.orientation[k], expected.orientation[k], 1e-3) << step;
    const NodeReport report = rig.node.report();
    EXPECT_EQ(report.counters["clock_set.imu"], 1);
    EXPECT_EQ(report.counters["reset.clock"], 0);
    EXPECT_EQ(report.counters["level.lost"], 0);
    EXPECT_TRUE(report.faults.empty()) << report.faults.front();
  }
}

/// The vehicle was driven on meanwhile: a clock that was set would leave it where it was.
TEST_F(EkfNodeTest, SensorsThatWereBothSilentForSecondsAreNoClockThatWasSet) {
  Rig rig(config_);
  for (std::size_t i = 0; i < drive_.imu.size(); ++i) {
    if (i >= 1000 && i < 1300) continue;
    const auto number = static_cast<std::int32_t>(i < 1000 ? i : i - 300);
    rig.send("WHEELS", message_of(drive_.wheels[i], number));
    rig.send("IMU", message_of(drive_.imu[i], number));
  }
  rig.finish();
  const NodeReport report = rig.node.report();
  EXPECT_EQ(report.counters["clock_set.imu"], 0);
  EXPECT_GE(report.counters["reset.clock"], 1);
  EXPECT_EQ(rig.odometry.back().utime, drive_.imu.back().utime);
}

}  // namespace
}  // namespace curbstone::ekf
