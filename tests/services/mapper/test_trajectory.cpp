#include "services/mapper/trajectory.hpp"

#include <gtest/gtest.h>

#include "tests/services/mapper/mapper_drive.hpp"

namespace curbstone::mapper {
namespace {

const Pose kMapOdom = test::pose(3, -2, 0.1, 0, 0, 0.4);

class TrajectoryTest : public ::testing::Test {
 protected:
  TrajectoryTest() { atlas_.visit(test::utime(0), Pose::Identity(), {}); }
  void drive(int scans, double speed, bool with_odometry = true) {
    for (int i = 0; i < scans; ++i) {
      time_ += test::kPeriod;
      x_ += speed * test::kPeriod;
      const Pose T_map_base = test::pose(x_, 0, 0, 0, 0, 0);
      const Pose T_odom_base = kMapOdom.inverse() * T_map_base;
      trajectory_.add({test::utime(time_), ++revolution_, T_map_base, atlas_.reference(),
                       with_odometry ? std::optional(T_odom_base) : std::nullopt},
                      atlas_);
    }
  }
  /// Drives on, then 5 m beside of where odometry is, and finds the vehicle where odometry has it.
  std::optional<std::int64_t> agreed_before_going_astray() {
    drive(20, 1);
    const Pose T_odom_base = kMapOdom.inverse() * test::pose(x_, 0, 0, 0, 0, 0);
    time_ += test::kPeriod;
    trajectory_.add({test::utime(time_), ++revolution_, test::pose(x_, 5, 0, 0, 0, 0), atlas_.reference(), T_odom_base},
                    atlas_);
    return trajectory_.last_agreement(test::pose(x_, 0, 0, 0, 0, 0), test::utime(time_), T_odom_base, atlas_);
  }
  /// That what the map has and what odometry said lead to the odom frame, as the map has it: `T_map_odom`.
  static void expect_odometry(const TrajectoryPoint& point, const Pose& T_map_odom = kMapOdom) {
    ASSERT_TRUE(point.T_odom_base) << point.utime;
    EXPECT_TRUE((point.T_map_base * point.T_odom_base->inverse()).isApprox(T_map_odom, 1e-5)) << point.utime;
  }

  pose_graph::Atlas atlas_{config::AtlasConfig{}};
  Trajectory trajectory_;
  double time_ = 0;  // s
  double x_ = 0;     // m
  std::int32_t revolution_ = 0;
};

TEST_F(TrajectoryTest, KnowsWhatOdometrySaidOfItsLastPoses) {
  drive(40 * 20, 1);
  const auto points = trajectory_.points(atlas_);
  ASSERT_EQ(points.size(), 800U);
  for (std::size_t i = 201; i < 800; ++i) expect_odometry(points[i]);
  EXPECT_FALSE(points[100].T_odom_base) << "it is too long ago";
  drive(1, 1, false);
  EXPECT_FALSE(trajectory_.points(atlas_)[799].T_odom_base) << "it did not go on";
}

TEST_F(TrajectoryTest, OfAClosedLoopHasTheOdomFrameWhereTheMapHasItThen) {
  drive(20, 1);
  const Pose T_new_old = test::pose(0.3, 0.1, 0, 0, 0, 0.02);
  atlas_.move({T_new_old});
  for (const TrajectoryPoint& point : trajectory_.points(atlas_)) expect_odometry(point, T_new_old * kMapOdom);
}

TEST_F(TrajectoryTest, OfASlowVehicleHasAPoseEachFewCentimetresAndWhatOdometrySaidThere) {
  drive(200, 0.2);
  const auto points = trajectory_.points(atlas_);
  EXPECT_LT(points.size(), 70U);
  for (const TrajectoryPoint& point : points) expect_odometry(point);
}

TEST_F(TrajectoryTest, AfterTheClockWasSetBackNothingIsRolledBackAndOdometryIsKnownAnew) {
  drive(40, 1);
  time_ -= 3600;
  drive(40, 1);
  const auto points = trajectory_.points(atlas_);
  ASSERT_EQ(points.size(), 80U);
  EXPECT_FALSE(points[39].T_odom_base) << "of another clock";
  for (std::size_t i = 41; i < 80; ++i) expect_odometry(points[i]);
  EXPECT_FALSE(agreed_before_going_astray());
}

TEST_F(TrajectoryTest, ThatTheClockWasSetBackIsSeenWithoutOdometryToo) {
  drive(40, 1, false);
  ASSERT_TRUE(agreed_before_going_astray());
  time_ -= 3600;
  drive(1, 1, false);
  EXPECT_FALSE(agreed_before_going_astray());
}

TEST_F(TrajectoryTest, OfAVehicleThatHasStoodForLongEndsWithWhatOdometrySays) {
  drive(20, 1);
  drive(90 * 20, 0);
  const auto points = trajectory_.points(atlas_);
  ASSERT_EQ(points.size(), 21U);
  EXPECT_FALSE(points[19].T_odom_base);
  expect_odometry(points.back());
  EXPECT_GT(points.back().utime, points[19].utime);
}

TEST_F(TrajectoryTest, RolledBackStillKnowsWhatOdometrySaidUntilThen) {
  drive(40, 1);
  const std::int64_t good_until = test::utime(time_);
  drive(20, 1);
  trajectory_.roll_back(good_until);
  auto points = trajectory_.points(atlas_);
  ASSERT_EQ(points.size(), 40U);
  for (const TrajectoryPoint& point : points) expect_odometry(point);
  drive(20, 1);
  points = trajectory_.points(atlas_);
  for (const TrajectoryPoint& point : points) expect_odometry(point);
  const Pose T_odom_base = kMapOdom.inverse() * test::pose(x_ + 2, 0, 0, 0, 0, 0);
  EXPECT_EQ(trajectory_.last_agreement(test::pose(x_ + 2, 0, 0, 0, 0, 0), test::utime(time_ + 1), T_odom_base, atlas_),
            std::nullopt)
      << "the last pose agrees";
  EXPECT_EQ(trajectory_.last_agreement(test::pose(x_, 30, 0, 0, 0, 0), test::utime(time_ + 1), T_odom_base, atlas_),
            std::nullopt)
      << "none agrees";
}

TEST_F(TrajectoryTest, HasNoPosesBeforeTheFirst) {
  EXPECT_TRUE(trajectory_.points(atlas_).empty());
}

}  // namespace
}  // namespace curbstone::mapper
