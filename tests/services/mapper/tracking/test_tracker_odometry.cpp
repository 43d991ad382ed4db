#include <gtest/gtest.h>

#include "tests/services/mapper/mapper_drive.hpp"
#include "tests/services/mapper/round_street.hpp"

namespace curbstone::mapper::tracking {
namespace {

using test::utime;

/// Odometry as of a filter that tilts at once, after `leap` s, by 0.12 rad about `axis`.
void add_leaping_odometry(test::MapperDrive& drive, double leap, const Eigen::Vector3d& axis) {
  const Pose tilt(Eigen::AngleAxisd(0.12, axis));
  for (double t = -0.05; t < 6; t += 0.01) {
    const Pose T_odom_base = drive.trajectory(0).inverse() * drive.trajectory(t);
    drive.odometry.add({utime(t), t < leap ? T_odom_base : T_odom_base * tilt, true, false});
  }
}

TEST(TrackerOdometry, ALeapOfTheTiltOfOdometryIsNotFollowed) {
  for (const Eigen::Vector3d& axis : {Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, -1, 0), Eigen::Vector3d(1, 0, 0)}) {
    test::MapperDrive drive;
    add_leaping_odometry(drive, 2.52, axis);
    for (int i = 0; i < 80; ++i) {
      const auto update = drive.step();
      ASSERT_TRUE(update && update->registered) << i;
      const Pose error = drive.truth(update->utime).inverse() * drive.T_world_map * update->T_map_base;
      EXPECT_LT(error.translation().norm(), 0.04) << i << " about " << axis.transpose();
      EXPECT_LT(angle_of(error), 0.5 * test::kDegree) << i << " about " << axis.transpose();
    }
    EXPECT_GE(drive.mapper->counters()["odometry.not_believed"], 1) << axis.transpose();
  }
}

/// As of a gyro of twice the scale, by which the filter then disowns wheels that are right, and slows down.
TEST(TrackerOdometry, WhereItsWayIsDeniedItsTurnIsNotBelievedEither) {
  test::MapperDrive drive;
  drive.world = test::round_street();
  drive.trajectory = [](double t) { return test::around(t / 4); };
  const double turn = test::kSpeed / test::kRadius / 4;  // rad/s
  Pose T_odom_base = Pose::Identity();
  for (double t = -0.05; t < 8; t += 0.01) {
    drive.odometry.add({utime(t), T_odom_base, true, false, false});
    T_odom_base = T_odom_base * scan::move({{t < 3 ? 3.0 : 1.0, 0, 0}, {0, 0, 2 * turn}}, 0.01);
  }
  for (int i = 0; i < 120; ++i) {
    const auto update = drive.step();
    ASSERT_TRUE(update) << i;
    const Pose error = drive.truth(update->utime).inverse() * drive.T_world_map * update->T_map_base;
    ASSERT_LT(angle_of(error), (i < 90 ? 4 : 1) * test::kDegree) << i;
  }
  EXPECT_EQ(drive.mapper->counters()["faults.odometry.way"], 1);
}

}  // namespace
}  // namespace curbstone::mapper::tracking
