#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>

#include "tests/services/ekf/ekf_node_test.hpp"

namespace curbstone::ekf {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

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
                           "dropped.duplicate.imu", "refused.second_sender.imu", "dropped.duplicate.wheels"}) {
    EXPECT_GT(report.counters[name], 100) << name;
  }
}

/// A gyro that ends at `range` (rad/s), and says so or does not.
imu_t clipped(imu_t sample, double range, bool flagged) {
  for (double& rate : sample.angular_rate) {
    if (std::abs(rate) > range && flagged) sample.status |= imu_t::CLIPPING;
    rate = std::clamp(rate, -range, range);
  }
  return sample;
}

/// A second driver of another device on the channel, or a log of an hour ago that is played into the bus.
TEST_F(EkfNodeTest, ASecondSenderOfAChannelIsNotUsedAndIsAFault) {
  for (const std::int64_t later : {3'000LL, -3'600'000'000LL}) {
    Rig clean(config_), mixed(config_);
    for (std::size_t i = 0; i < drive_.imu.size(); ++i) {
      send(clean, i);
      send(mixed, i);
      if (i < 500) continue;
      imu_t imu = message_of(drive_.imu[i], static_cast<std::int32_t>(i) + 70'000);
      wheels_t wheels = message_of(drive_.wheels[i], static_cast<std::int32_t>(i) - 400);
      imu.utime += later;
      wheels.utime += later;
      imu.angular_rate[2] += 1.0;
      wheels.angle[0] += 300.0;
      mixed.send("IMU", imu);
      mixed.send("WHEELS", wheels);
    }
    EXPECT_THAT(mixed.node.report().faults,
                ElementsAre(HasSubstr("IMU: two programs send it"), HasSubstr("WHEELS: two programs send it")));
    clean.finish();
    mixed.finish();
    EXPECT_TRUE(clean.bytes == mixed.bytes) << later;
    const Counters counters = mixed.node.report().counters;
    const auto others = static_cast<std::int64_t>(drive_.imu.size()) - 500;
    EXPECT_EQ(counters["refused.second_sender.imu"], others);
    EXPECT_EQ(counters["refused.second_sender.wheels"], others);
    EXPECT_EQ(counters["lost.imu"] + counters["lost.wheels"], 0);
  }
}

TEST_F(EkfNodeTest, SamplesThatClipAreAsIfLost) {
  Rig clipping(config_);
  Rig losing(config_);
  int clips = 0;
  for (std::size_t i = 0; i < drive_.imu.size(); ++i) {
    const imu_t imu = clipped(message_of(drive_.imu[i], static_cast<std::int32_t>(i)), 0.2, true);
    const wheels_t wheels = message_of(drive_.wheels[i], static_cast<std::int32_t>(i));
    clipping.send("WHEELS", wheels);
    losing.send("WHEELS", wheels);
    clipping.send("IMU", imu);
    clips += imu.status & imu_t::CLIPPING ? 1 : 0;
    if (!(imu.status & imu_t::CLIPPING)) losing.send("IMU", imu);
  }
  clipping.finish();
  losing.finish();
  EXPECT_GT(clips, 300);
  EXPECT_TRUE(clipping.bytes == losing.bytes);
  EXPECT_EQ(clipping.node.report().counters["refused.clipping.imu"], clips);
  EXPECT_EQ(clipping.node.report().counters["lost.imu"], 0);
}

TEST_F(EkfNodeTest, ALastingClipIsBridgedByTheWheelsAndNotBelieved) {
  const auto worst_yaw = [&](bool flagged) {
    Rig rig(config_);
    for (std::size_t i = 0; i < drive_.imu.size(); ++i) {
      rig.send("WHEELS", message_of(drive_.wheels[i], static_cast<std::int32_t>(i)));
      rig.send("IMU", clipped(message_of(drive_.imu[i], static_cast<std::int32_t>(i)), 0.2, flagged));
    }
    rig.finish();
    double worst = 0.0;
    const std::size_t start = drive_.index_of(rig.odometry.front().utime);
    for (const odometry_t& m : rig.odometry) {
      const Pose truth = drive_.T_odom_base(drive_.index_of(m.utime), start);
      const Pose pose = pose_from_arrays(m.position, m.orientation);
      const double error = roll_pitch_yaw(truth.linear().transpose() * pose.linear()).z();
      worst = std::max(worst, std::abs(error));
    }
    std::printf("[ gyro ends at 0.2 rad/s, %s: yaw at most %.2f deg wrong ]\n", flagged ? "and says so" : "unsaid",
                worst * 180.0 / M_PI);
    return worst;
  };
  const double refused = worst_yaw(true), used = worst_yaw(false);
  EXPECT_LT(refused, 2.0 * M_PI / 180.0);
  EXPECT_GT(used, 2.0 * refused);
}

TEST_F(EkfNodeTest, AnImuThatClipsIsDistinguishedFromOneThatIsMissing) {
  Rig rig(config_);
  const std::size_t half = drive_.imu.size() / 2, gone = half + drive_.imu.size() / 10;
  for (std::size_t i = 0; i < drive_.imu.size(); ++i) {
    rig.send("WHEELS", message_of(drive_.wheels[i], static_cast<std::int32_t>(i)));
    imu_t imu = message_of(drive_.imu[i], static_cast<std::int32_t>(i));
    if (i >= half) imu.status |= imu_t::CLIPPING;
    if (i < gone) rig.send("IMU", imu);
    rig.node.tick(drive_.wheels[i].utime);
    if (i + 1 == half) {
      EXPECT_THAT(rig.node.report().faults, IsEmpty());
    }
    if (i + 1 == gone) {
      EXPECT_THAT(rig.node.report().faults, ElementsAre("IMU: it clips, odometry coasts on the wheels"));
    }
  }
  rig.finish();
  EXPECT_THAT(rig.node.report().faults, ElementsAre(HasSubstr("IMU: silent"), "no IMU: odometry coasts on the wheels"));
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
}  // namespace curbstone::ekf
