#include "services/ekf/ekf_node.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <curbstone/map_pose_t.hpp>
#include <curbstone/odometry_t.hpp>
#include <curbstone/pose_t.hpp>
#include <limits>
#include <random>

#include "common/local_bus.hpp"
#include "tests/services/ekf/sample_messages.hpp"
#include "tests/services/ekf/simulated_drive.hpp"

namespace curbstone {
namespace {

DriveOptions short_drive() {
  DriveOptions o;
  o.seconds = 20.0;
  o.gyro_bias << 0.004, -0.006, 0.008;
  o.accelerometer_bias << 0.03, -0.02, 0.04;
  return o;
}

class EkfNodeTest : public ::testing::Test {
 protected:
  EkfNodeTest() : drive_(simulate_drive(short_drive(), config_.vehicle)) {}

  /// A node on a bus of its own, whose every published byte is kept.
  struct Rig {
    explicit Rig(const EkfConfig& config) : node(config, bus) {
      bus.tap([this](const std::string& channel, const void* data, int size, std::int64_t) {
        if (channel == "ODOMETRY" || channel == "POSE")
          bytes.append(static_cast<const char*>(data), static_cast<std::size_t>(size));
      });
      node.connect(bus);
      bus.subscribe<odometry_t>("ODOMETRY", [this](const odometry_t& m) { odometry.push_back(m); });
      bus.subscribe<pose_t>("POSE", [this](const pose_t& m) { poses.push_back(m); });
    }
    template <class Message>
    void send(const std::string& channel, const Message& message) {
      bus.publish(channel, message);
      bus.dispatch();
    }
    void finish() {
      node.finish();
      bus.dispatch();
    }
    LocalBus bus;
    EkfNode node;
    std::vector<odometry_t> odometry;
    std::vector<pose_t> poses;
    std::string bytes;
  };

  void send(Rig& rig, std::size_t i) {
    rig.send("WHEELS", message_of(drive_.wheels[i], static_cast<std::int32_t>(i)));
    rig.send("IMU", message_of(drive_.imu[i], static_cast<std::int32_t>(i)));
  }

  EkfConfig config_;
  Drive drive_;
};

TEST_F(EkfNodeTest, PublishesOneOdometryAndOnePoseForEveryImuSample) {
  Rig rig(config_);
  for (std::size_t i = 0; i < drive_.imu.size(); ++i) send(rig, i);
  rig.finish();
  ASSERT_FALSE(rig.odometry.empty());
  const std::size_t first = drive_.index_of(rig.odometry.front().utime);
  EXPECT_NEAR(seconds_between(drive_.imu.front().utime, rig.odometry.front().utime), config_.start.still, 0.02);
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

map_pose_t map_pose(const TruePose& truth) {
  map_pose_t m{};
  m.utime = truth.utime;
  m.epoch = 7;
  m.flags = map_pose_t::REGISTERED;
  pose_to_arrays(truth.T_world_base, m.map_base_position, m.map_base_orientation);
  for (int i = 0; i < 6; ++i) m.covariance[7 * i] = 1e-5F;
  return m;
}

TEST_F(EkfNodeTest, MapPosesAreTakenOnlyIfWantedAndWorkTheSameHoweverSoonTheyCome) {
  const auto run = [&](bool fuse, std::size_t samples_late) {
    config_.fuse_map = fuse;
    Rig rig(config_);
    for (std::size_t i = 0; i < drive_.imu.size(); ++i) {
      send(rig, i);
      if (i % 5 == 0 && i >= 200 + samples_late) rig.send("MAP_POSE", map_pose(drive_.truth[i - samples_late]));
    }
    rig.finish();
    EXPECT_EQ(rig.node.report().counters["map.used"] > 20, fuse);
    EXPECT_EQ(rig.node.report().counters["dropped.late.map"], 0);
    return rig.bytes;
  };
  const std::string alone = run(false, 0);
  const std::string at_once = run(true, 0);
  EXPECT_TRUE(at_once == run(true, 20));  // 0.2 s late, as a mapper that works hard
  EXPECT_FALSE(at_once == alone);
}

TEST_F(EkfNodeTest, MapPosesThatJumpOrAreNoneDoNotMoveOdom) {
  config_.fuse_map = true;
  Rig rig(config_);
  std::mt19937 random(4);
  for (std::size_t i = 0; i < drive_.imu.size(); ++i) {
    send(rig, i);
    if (i % 5 != 0 || i < 200) continue;
    map_pose_t m = map_pose(drive_.truth[i]);
    switch (random() % 6) {
      case 0:
        m.map_base_position[0] += 30.0;
        break;
      case 1:
        m.map_base_orientation[0] = std::numeric_limits<double>::quiet_NaN();
        break;
      case 2:
        m.covariance[0] = -std::numeric_limits<float>::infinity();
        break;
      case 3:
        m.flags = 0;
        break;
      case 4:
        m.utime += static_cast<std::int64_t>(random()) * 1000;
        break;
      default:
        break;
    }
    rig.send("MAP_POSE", m);
  }
  rig.finish();
  for (std::size_t i = 1; i < rig.odometry.size(); ++i) {
    const Eigen::Vector3d step =
        Eigen::Vector3d(rig.odometry[i].position) - Eigen::Vector3d(rig.odometry[i - 1].position);
    ASSERT_LT(step.norm(), 0.05);
  }
  EXPECT_NEAR(rig.odometry.back().velocity[0], drive_.truth.back().velocity.x(), 0.1);
}

TEST_F(EkfNodeTest, MapPosesThatTheMapperDoesNotTrustAreNotTakenAndCounted) {
  config_.fuse_map = true;
  Rig alone(EkfConfig{});
  Rig rig(config_);
  for (std::size_t i = 0; i < drive_.imu.size(); ++i) {
    send(alone, i);
    send(rig, i);
    if (i % 5 != 0 || i < 200) continue;
    map_pose_t m = map_pose(drive_.truth[i]);
    m.map_base_position[0] += 0.02 * static_cast<double>(i % 50);
    switch (i / 5 % 4) {
      case 0:
        m.flags |= map_pose_t::LOST;  // found again perhaps, or somewhere that looks like it
        break;
      case 1:
        m.flags = 0;
        break;
      case 2:
        m.covariance[7] = 4.0F;
        break;
      default:
        m.map_base_position[1] = std::numeric_limits<double>::infinity();
        break;
    }
    rig.send("MAP_POSE", m);
  }
  alone.finish();
  rig.finish();
  EXPECT_TRUE(rig.bytes == alone.bytes);
  const NodeReport report = rig.node.report();
  for (const char* cause : {"lost", "not_registered", "uncertain", "not_finite"})
    EXPECT_GT(report.counters["refused." + std::string(cause) + ".map"], 80) << cause;
  EXPECT_EQ(report.counters["map.used"], 0);
}

TEST_F(EkfNodeTest, SaysWhichSensorIsSilentAndThatItRecovered) {
  Rig rig(config_);
  for (std::size_t i = 0; i < 500; ++i) send(rig, i);
  EXPECT_TRUE(rig.node.report().faults.empty());
  for (std::size_t i = 500; i < 700; ++i)
    rig.send("WHEELS", message_of(drive_.wheels[i], static_cast<std::int32_t>(i)));
  EXPECT_THAT(rig.node.report().faults, ::testing::Contains(::testing::HasSubstr("IMU: silent for")));
  EXPECT_THAT(rig.node.report().faults, ::testing::Contains(::testing::HasSubstr("coasts on the wheels")));
  EXPECT_TRUE(rig.odometry.back().flags & odometry_t::NO_IMU);
  for (std::size_t i = 700; i < 900; ++i) send(rig, i);
  EXPECT_TRUE(rig.node.report().faults.empty());
  for (std::size_t i = 900; i < 1100; ++i) rig.send("IMU", message_of(drive_.imu[i], static_cast<std::int32_t>(i)));
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
  rig.node.tick(1'700'000'000'000'000);
  const std::vector<std::string> faults = rig.node.report().faults;
  EXPECT_THAT(faults, ::testing::Contains("IMU: nothing heard yet"));
  EXPECT_THAT(faults, ::testing::Contains("WHEELS: nothing heard yet"));
  EXPECT_THAT(faults, ::testing::Contains(::testing::HasSubstr("no odometry yet")));
}

TEST_F(EkfNodeTest, PassesOnTheDrivesFaults) {
  Rig rig(config_);
  for (std::size_t i = 0; i < 200; ++i) send(rig, i);
  wheels_t m = message_of(drive_.wheels[200], 200);
  m.faults[1] = 0x2310;
  rig.send("WHEELS", m);
  EXPECT_THAT(rig.node.report().faults, ::testing::ElementsAre("WHEELS: right drive reports fault 0x2310"));
}

TEST_F(EkfNodeTest, GarbageIsCountedAndChangesNothing) {
  Rig clean(config_);
  Rig dirty(config_);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < drive_.imu.size(); ++i) {
    send(clean, i);
    send(dirty, i);
    imu_t imu = message_of(drive_.imu[i], static_cast<std::int32_t>(i));
    wheels_t wheels = message_of(drive_.wheels[i], static_cast<std::int32_t>(i));
    imu.utime += 1000;
    wheels.utime += 1000;
    switch (i % 8) {
      case 0:
        imu.angular_rate[i % 3] = nan;
        break;
      case 1:
        imu.acceleration[i % 3] = infinite;
        break;
      case 2:
        imu.acceleration[i % 3] = -1e6;
        break;
      case 3:
        imu.utime = -5;
        break;
      case 4:
        imu.utime = std::numeric_limits<std::int64_t>::max();
        break;
      case 5:
        imu.utime -= 1000;
        break;  // a duplicate
      case 6:
        imu.utime += 3'600'000'000;
        break;
      case 7:
        imu.utime -= 3'600'000'000;
        break;
    }
    if (i % 8 < 3) wheels.angle[i % 2] = i % 8 == 0 ? nan : (i % 8 == 1 ? infinite : 1e300);
    if (i % 8 >= 3)
      wheels.utime = i % 8 == 3 ? 0 : (i % 8 == 4 ? std::numeric_limits<std::int64_t>::min() : wheels.utime - 1000);
    dirty.send("IMU", imu);
    dirty.send("WHEELS", wheels);
  }
  clean.finish();
  dirty.finish();
  EXPECT_TRUE(clean.bytes == dirty.bytes);
  const NodeReport report = dirty.node.report();
  for (const char* name : {"refused.not_finite.imu", "refused.absurd.imu", "refused.stamp.imu",
                           "refused.not_finite.wheels", "refused.absurd.wheels", "refused.stamp.wheels",
                           "dropped.duplicate.imu", "dropped.stray_stamp.imu", "dropped.duplicate.wheels"}) {
    EXPECT_GT(report.counters[name], 100) << name;
  }
}

TEST_F(EkfNodeTest, SurvivesPlausibleNonsenseAndRecovers) {
  Rig rig(config_);
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  for (std::size_t i = 0; i < drive_.imu.size(); ++i) {
    imu_t imu = message_of(drive_.imu[i], static_cast<std::int32_t>(i));
    wheels_t wheels = message_of(drive_.wheels[i], static_cast<std::int32_t>(i));
    if (i > 500 && i < 800) {
      for (double& x : imu.angular_rate) x = 60.0 * any(random);
      for (double& x : imu.acceleration) x = 300.0 * any(random);
      for (double& x : wheels.angle) x = 1e6 * any(random);
      imu.utime += static_cast<std::int64_t>(30'000 * any(random));
      wheels.utime += static_cast<std::int64_t>(30'000 * any(random));
    }
    rig.send("WHEELS", wheels);
    rig.send("IMU", imu);
  }
  rig.finish();
  for (const odometry_t& m : rig.odometry) {
    ASSERT_TRUE(is_finite(pose_from_arrays(m.position, m.orientation)));
    ASSERT_TRUE(Eigen::Vector3d(m.velocity).allFinite());
    for (const float c : m.pose_covariance) ASSERT_TRUE(std::isfinite(c));
  }
  const odometry_t& last = rig.odometry.back();
  EXPECT_NEAR(last.velocity[0], drive_.truth.back().velocity.x(), 0.2);
  EXPECT_LT(std::abs(last.velocity[1]) + std::abs(last.velocity[2]), 0.3);
}

TEST_F(EkfNodeTest, RandomBytesOnItsChannelsAreCounted) {
  Rig rig(config_);
  std::mt19937 random(11);
  std::vector<std::uint8_t> good(static_cast<std::size_t>(message_of(drive_.imu[0], 0).getEncodedSize()));
  for (std::size_t i = 0; i < 1000; ++i) {
    message_of(drive_.imu[i], static_cast<std::int32_t>(i)).encode(good.data(), 0, static_cast<int>(good.size()));
    std::vector<std::uint8_t> bytes(good.begin(),
                                    good.begin() + static_cast<std::ptrdiff_t>(random() % (good.size() + 1)));
    for (int flips = 0; flips < 3 && !bytes.empty(); ++flips)
      bytes[random() % bytes.size()] ^= static_cast<std::uint8_t>(1U << random() % 8);
    rig.bus.inject(i % 2 ? "IMU" : "WHEELS", bytes.data(), static_cast<int>(bytes.size()));
    rig.bus.dispatch();
  }
  EXPECT_GT(rig.bus.counters()["refused.undecodable"], 500);
  for (std::size_t i = 0; i < drive_.imu.size(); ++i) send(rig, i);
  EXPECT_FALSE(rig.odometry.empty());
}

}  // namespace
}  // namespace curbstone
