#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "tests/services/ekf/ekf_node_test.hpp"

namespace curbstone::ekf {
namespace {

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
}  // namespace curbstone::ekf
