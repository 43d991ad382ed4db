// An IMU that is missing when the vehicle sets off: the wheels alone start odometry, and the IMU joins in when it
// comes.
#include <gtest/gtest.h>

#include "tests/services/ekf/ekf_node_test.hpp"
#include "tests/services/ekf/town_drive.hpp"

namespace curbstone::ekf {
namespace {

class MissingImu : public EkfNodeTest {
 protected:
  /// Drives through a town for 60 s. The IMU sends from `from` s on.
  void drive(Rig& rig, double from) {
    town_ = simulate_town_drive({.seconds = 60.0}, config_.vehicle);
    for (std::size_t i = 0; i < town_.imu.size(); ++i) {
      if (i < town_.wheels.size()) rig.send("WHEELS", message_of(town_.wheels[i], static_cast<std::int32_t>(i)));
      if (seconds(town_.imu[i].utime) >= from) rig.send("IMU", message_of(town_.imu[i], static_cast<std::int32_t>(i)));
    }
    rig.finish();
  }
  [[nodiscard]] double seconds(std::int64_t utime) const {
    return base::seconds_between(town_.imu.front().utime, utime);
  }
  /// Largest error on the ground of the way since `from` s, m.
  [[nodiscard]] double error(const Rig& rig, double from) const {
    double most = 0.0;
    std::optional<Pose> T_odom_world;
    for (const odometry_t& message : rig.odometry) {
      if (seconds(message.utime) < from) continue;
      const Pose truth = town_.truth[std::min(town_.index_of(message.utime), town_.truth.size() - 1)].T_world_base;
      const Pose pose = pose_from_arrays(message.position, message.orientation);
      if (!T_odom_world) T_odom_world = pose * truth.inverse();
      most = std::max(most, (pose.translation() - (*T_odom_world * truth).translation()).head<2>().norm());
    }
    return most;
  }
  Drive town_;
};

TEST_F(MissingImu, TheWheelsStartOdometryOnceTheyHaveTurnedAndItHasBeenWaitedFor) {
  Rig rig(config_);
  drive(rig, 1000.0);
  ASSERT_FALSE(rig.odometry.empty());
  EXPECT_EQ(rig.node.report().counters["starts.without_imu"], 1);
  EXPECT_LT(seconds(rig.odometry.front().utime), config_.start.patience + 3.0);
  for (const odometry_t& message : rig.odometry) {
    ASSERT_TRUE(message.flags & odometry_t::INITIALISED);
    ASSERT_TRUE(message.flags & odometry_t::NO_IMU);
  }
  EXPECT_LT(error(rig, 0.0), 8.0);  // without a gyro the wheels' slips turn it
}

TEST_F(MissingImu, AKilledFilterIsSucceededOnTheWheels) {
  for (const double dead : {0.2, 1.0}) {  // s
    Rig rig(config_);
    drive(rig, 1000.0);
    filter::Filter killed(config_), next(config_);
    std::vector<model::Estimate> before, after;
    for (const base::WheelSample& sample : town_.wheels) {
      if (seconds(sample.utime) < 30.0) killed.add(sample, before);
    }
    next.inherit(killed.belief());
    for (const base::WheelSample& sample : town_.wheels) {
      if (seconds(sample.utime) >= 30.0 + dead && seconds(sample.utime) < 33.0) next.add(sample, after);
    }
    ASSERT_FALSE(after.empty());
    EXPECT_EQ(next.counters()["starts.inherited"], 1);
    EXPECT_LT(seconds(after.front().utime), 30.0 + dead + filter::Filter::kImuAwaited + 0.1);
    EXPECT_TRUE(after.front().level);
    const auto in_time = std::find_if(rig.odometry.begin(), rig.odometry.end(),
                                      [&](const odometry_t& m) { return m.utime >= after.back().utime; });
    ASSERT_NE(in_time, rig.odometry.end());
    const Pose undisturbed = pose_from_arrays(in_time->position, in_time->orientation);
    EXPECT_LT((undisturbed.inverse() * after.back().T_odom_base).translation().head<2>().norm(), 0.5) << dead;
  }
}

TEST_F(MissingImu, AStandstillIsWaitedOutBecauseTheImuStartsBetterThere) {
  Rig rig(config_);
  DriveOptions options = short_drive();
  options.stand_first = 12.0;
  const Drive drive = simulate_drive(options, config_.vehicle);
  for (std::size_t i = 0; i < drive.imu.size(); ++i) {
    rig.send("WHEELS", message_of(drive.wheels[i], static_cast<std::int32_t>(i)));
    if (i >= 1000) rig.send("IMU", message_of(drive.imu[i], static_cast<std::int32_t>(i)));
  }
  rig.finish();
  EXPECT_EQ(rig.node.report().counters["starts.without_imu"], 0);
  EXPECT_EQ(rig.node.report().counters["starts.standing"], 1);
}

TEST_F(MissingImu, WhenItComesTheOdometryIsNotLevelUntilItHasLevelledItself) {
  for (const double from : {12.0, 25.0, 40.0}) {
    Rig rig(config_);
    drive(rig, from);
    double level_at = 0.0;
    for (const odometry_t& message : rig.odometry) {
      const bool not_level = (message.flags & odometry_t::NOT_LEVEL) != 0;
      if (not_level) level_at = seconds(message.utime);
      if (seconds(message.utime) < from - 0.3) {
        EXPECT_FALSE(not_level);
      }
    }
    EXPECT_GT(level_at, from) << from;
    EXPECT_LT(level_at, from + config_.start.level_patience + 0.5) << from;
    EXPECT_FALSE(rig.odometry.back().flags & odometry_t::NO_IMU);
    EXPECT_LT(error(rig, from + 5.0), 3.0) << from;
  }
}

}  // namespace
}  // namespace curbstone::ekf
