#include "services/mapper/mapper.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <tuple>

#include "tests/services/mapper/mapper_drive.hpp"

namespace curbstone::mapper {
namespace {

using test::driving;
using test::kPeriod;
using test::scan_of;
using test::utime;
using Drive = test::MapperDrive;

TEST(Mapper, FollowsADriveWithPoorOdometry) {
  Drive drive;
  drive.with_odometry(5, 1.03);
  std::optional<MapperUpdate> update;
  for (int i = 0; i < 60; ++i) {
    update = drive.step();
    ASSERT_TRUE(update && update->registered) << i;
    EXPECT_TRUE(update->with_odometry);
  }
  EXPECT_LT(drive.error(*update), 0.03);  // of 9 m; odometry alone is off by 0.27
  // map and odom are tied together by this pose
  EXPECT_TRUE((update->T_map_odom * drive.odometry.at(update->utime)).isApprox(update->T_map_base, 1e-9));
}

TEST(Mapper, FollowsADriveWithoutOdometry) {
  Drive drive;
  std::optional<MapperUpdate> update;
  for (int i = 0; i < 60; ++i) {
    update = drive.step();
    ASSERT_TRUE(update && update->registered) << i;
    EXPECT_FALSE(update->with_odometry);
  }
  EXPECT_LT(drive.error(*update), 0.08);
  EXPECT_GT(drive.dense().size(), 10'000);
}

TEST(Mapper, MakesTheSameMapWithASecondThreadAsWithoutAndWheneverThereIsAPause) {
  Drive one, two;
  one.config.threads = 1;
  two.config.threads = 2;
  for (Drive* drive : {&one, &two}) {
    drive->mapper.emplace(drive->config);
    for (int i = 0; i < 60; ++i) {
      (void)drive->step();
      if (drive != &two || i % 3 == 0) continue;
      drive->mapper->wait_inserted();
      drive->mapper->begin_free_space_removal();
      if (i % 2 == 0) (void)drive->mapper->take_changed();
    }
    (void)drive->mapper->finish();
  }
  const dense_map::DenseMap& a = one.dense();
  const dense_map::DenseMap& b = two.dense();
  ASSERT_GT(a.size(), 10'000);
  ASSERT_EQ(a.keys(), b.keys());
  for (const TileKey& key : a.keys()) {
    EXPECT_TRUE(a.tile(key)->read()->records == b.tile(key)->read()->records) << key.x << " " << key.y;
    EXPECT_EQ(a.tile(key)->utime(), b.tile(key)->utime());
  }
}

/// After 12 s the street comes along through the bend, for a while: as between two lorries.
class MapperInABendTest : public ::testing::Test {
 protected:
  struct Drives {
    bool turn_by_odometry = true;
    bool confirmed = true;  // wheels and gyro turn alike
    int along = 30;         // scans
  };
  void drive(const Drives& how) {
    const auto& [turn_by_odometry, confirmed, num_along] = how;
    drive_.config.tracker.turn_by_odometry = turn_by_odometry;
    drive_.mapper.emplace(drive_.config);
    constexpr int kBegin = 240;
    const int end = kBegin + num_along + 30;
    for (double t = -0.05; t < end * kPeriod + 1; t += 0.01)
      drive_.odometry.add({utime(t), driving(0).inverse() * driving(t), true, false, confirmed});
    for (int i = 0; i < end; ++i) {
      const bool along = i >= kBegin && i < kBegin + num_along;
      drive_.trajectory = along ? [](double t) { return driving(12) * scan::move({{3, 0, 0}, {0, 0, -0.1}}, t - 12); }
                                : test::SyntheticWorld::Trajectory(driving);
      const scan::Scan scan = drive_.next();
      drive_.trajectory = driving;
      update_ = drive_.step(scan);
      ASSERT_TRUE(update_) << i;
      if (i == kBegin + num_along - 1) {
        error_ = drive_.error(*update_);
        turn_refused_ = drive_.mapper->turn_refused();
      }
    }
  }
  [[nodiscard]] std::int64_t counter(const char* name) const { return drive_.mapper->counters()[name]; }

  Drive drive_;
  std::optional<MapperUpdate> update_;
  double error_ = 0;  // m, at the end of the bend
  bool turn_refused_ = false;
};

TEST_F(MapperInABendTest, WheelsAndGyroAreBelievedRatherThanWhatComesAlong) {
  drive({});
  EXPECT_TRUE(turn_refused_);
  EXPECT_LT(error_, 0.05);
  EXPECT_GE(counter("refused.turn"), 10);
  EXPECT_TRUE(update_->registered);
  EXPECT_FALSE(drive_.mapper->turn_refused());
  EXPECT_GT(drive_.mapper->turn_refused_at(), update_->utime - 2'500'000) << "it stays known when that was";
  EXPECT_LT(drive_.mapper->turn_refused_at(), update_->utime - 1'000'000);
  EXPECT_LT(drive_.error(*update_), 0.05);
}

TEST_F(MapperInABendTest, AfterSixSecondsTheMapBeginsAnewWhereOdometryHasLed) {
  drive({.along = 160});  // 8 s, 24 m
  EXPECT_EQ(counter("began_anew"), 1);
  EXPECT_LT(error_, 0.3) << "while the street came along for 24 m";
}

TEST_F(MapperInABendTest, WithoutTheKeyTheScansAreBelieved) {
  drive({.turn_by_odometry = false});
  EXPECT_FALSE(turn_refused_);
  EXPECT_GT(error_, 0.2);
  EXPECT_EQ(counter("refused.turn"), 0);
}

TEST_F(MapperInABendTest, WhereTheyDoNotAgreeTheScansAreBelieved) {
  drive({.confirmed = false});
  EXPECT_FALSE(turn_refused_);
  EXPECT_GT(error_, 0.2);
  EXPECT_EQ(counter("refused.turn"), 0);
}

TEST(Mapper, LevelsTheMapByOdometry) {
  Drive drive;
  const Pose tilted = test::pose(0, 0, 0, 0.03, -0.02, 0.8);
  for (int i = -5; i < 20; ++i) drive.odometry.add({test::utime(0.01 * i), tilted, true, true});
  const auto update = drive.step();
  ASSERT_TRUE(update);
  const Eigen::Vector3d rpy = roll_pitch_yaw(update->T_map_base.linear());
  EXPECT_NEAR(rpy.x(), 0.03, 1e-9);
  EXPECT_NEAR(rpy.y(), -0.02, 1e-9);
  EXPECT_NEAR(rpy.z(), 0, 1e-9);
  EXPECT_EQ(update->T_map_base.translation().norm(), 0);
}

TEST(Mapper, AScanFromAnotherPlaceIsRefusedAndChangesNothing) {
  Drive drive;
  drive.with_odometry(5);
  for (int i = 0; i < 30; ++i) (void)drive.step();
  const std::int64_t points = drive.dense().size();
  const std::int64_t keyframes = drive.mapper->counters()["keyframes"];
  // Somewhere else: a narrow yard, turned.
  test::SyntheticWorld elsewhere;
  elsewhere.boxes = {
      {{-3, -3, 0}, {-2, 3, 4}}, {{2.2, -3, 0}, {3, 3, 4}}, {{-3, 2.5, 0}, {3, 3, 4}}, {{-3, -3.4, 0}, {3, -2.1, 4}}};
  const scan::Scan kidnapped =
      test::scan_of(elsewhere.packets([](double) { return test::pose(0, 0, 0.0, 0, 0, 0.7); },
                                      drive.config.vehicle.T_base_lidar(), 30, 30 * test::kPeriod, test::kPeriod));
  const auto update = drive.step(kidnapped);
  ASSERT_TRUE(update);
  EXPECT_FALSE(update->registered);
  EXPECT_LT(drive.error(*update), 0.05);  // follows odometry
  EXPECT_EQ(drive.mapper->counters()["keyframes"], keyframes);
  EXPECT_LE(drive.dense().size(), points);
  EXPECT_EQ(drive.mapper->refused_in_a_row(), 1);
  ++drive.turn;
  const auto after = drive.step();
  ASSERT_TRUE(after && after->registered);
  EXPECT_LT(drive.error(*after), 0.03);
}

TEST(Mapper, SurvivesOdometryThatJumps) {
  Drive drive;
  drive.with_odometry(1.02);
  for (int i = 102; i < 500; ++i) {
    Pose T = drive.trajectory(0).inverse() * drive.trajectory(0.01 * i);
    T.translation() += Eigen::Vector3d(7, -4, 0);
    drive.odometry.add({test::utime(0.01 * i), T, true, false});
  }
  std::optional<MapperUpdate> update;
  for (int i = 0; i < 40; ++i) {
    update = drive.step();
    ASSERT_TRUE(update);
  }
  EXPECT_TRUE(update->registered);
  EXPECT_LT(drive.error(*update), 0.05);
}

TEST(Mapper, WhatHasTooFewPointsIsRefusedAndHalfAScanIsNot) {
  Drive drive;
  drive.with_odometry(5);
  for (int i = 0; i < 20; ++i) (void)drive.step();
  scan::Scan empty = drive.next();
  empty.points.clear();
  const auto by_odometry = drive.step(empty);
  ASSERT_TRUE(by_odometry && !by_odometry->registered);
  scan::Scan sparse = drive.next();
  sparse.points.resize(100);
  ASSERT_TRUE(drive.step(sparse));
  EXPECT_EQ(drive.mapper->counters()["refused.sparse"], 2);
  scan::Scan half = drive.next();
  half.points.resize(half.points.size() / 2);
  const auto update = drive.step(half);
  ASSERT_TRUE(update);
  EXPECT_LT(drive.error(*update), 0.03);
  const auto after = drive.step();
  ASSERT_TRUE(after && after->registered);
  EXPECT_LT(drive.error(*after), 0.03);
}

TEST(Mapper, SurvivesClocksThatJump) {
  for (const std::int64_t jump : {-5'000'000LL, -4'000'000'000'000LL, 3'600'000'000LL, 250'000'000'000'000LL}) {
    Drive drive;
    drive.world.boxes.push_back({{-16, 3, 0}, {-13, 6, 3}});  // a kiosk: the street looks different wherever one is
    for (int i = 0; i < 20; ++i) (void)drive.step();
    std::optional<MapperUpdate> update;
    scan::Scan last;
    for (int i = 0; i < 20; ++i) {
      scan::Scan scan = drive.next();
      scan.start += jump;
      scan.end += jump;
      last = scan;
      update = drive.step(scan);
      EXPECT_TRUE(i == 0 || (update && update->fix == tracking::Fix::kTracking)) << jump << " after " << i;
    }
    ASSERT_TRUE(update && update->registered) << jump;
    update->utime -= jump;
    EXPECT_LT(drive.error(*update), 0.08) << jump;
    EXPECT_LE(drive.mapper->counters()["refused.time"], 1);
  }
}

TEST(Mapper, StandingStillNeitherDriftsNorGrows) {
  Drive drive;
  drive.config.dense.start_hold_s = 2;
  drive.mapper.emplace(drive.config);
  drive.trajectory = [](double) { return test::pose(-10, 0, 0, 0, 0, 0); };
  std::int64_t points = 0;
  std::int64_t keyframes = 0;
  std::optional<MapperUpdate> update;
  for (int i = 0; i < 120; ++i) {
    update = drive.step();
    ASSERT_TRUE(update && update->registered);
    if (i == 80) {
      points = drive.dense().size();
      keyframes = drive.mapper->counters()["keyframes"];
    }
  }
  EXPECT_LT(drive.error(*update), 0.003);
  EXPECT_TRUE(update->stationary);
  EXPECT_LT(drive.dense().size(), points + points / 500);
  EXPECT_EQ(drive.mapper->counters()["keyframes"], keyframes);
}

TEST(Mapper, TheVehicleIsNoPartOfTheMap) {
  Drive drive;
  drive.config.dense.start_hold_s = 0;
  drive.mapper.emplace(drive.config);
  drive.trajectory = [](double) { return test::pose(-10, 0, 0, 0, 0, 0); };
  scan::Scan scan = drive.next();
  const Pose T_lidar_base = drive.config.vehicle.T_base_lidar().inverse();
  for (double x = -0.8; x < 0.8; x += 0.05) {
    for (double z = 0.3; z < 1.9; z += 0.1) {
      scan.points.push_back({(T_lidar_base * Eigen::Vector3d(x, 0.55, z)).cast<float>(), 0.01F, 0, 0});
    }
  }
  for (int i = 0; i < 40; ++i) {
    scan.start += 50'000;
    scan.end += 50'000;
    (void)drive.step(scan);
  }
  ASSERT_GT(drive.dense().size(), 1000);
  for (int x = -1; x <= 0; ++x) {
    for (int y = -1; y <= 0; ++y) {
      const dense_map::DenseTile* tile = drive.dense().tile({x, y});
      if (tile == nullptr) continue;
      for (const TilePoint& p : tile->read()->points()) {
        const double px = x * kTileSize + p.x * kPositionStep, py = y * kTileSize + p.y * kPositionStep;
        EXPECT_FALSE(std::abs(px) < 0.9 && std::abs(py) < 0.6 && p.z > 100);
      }
    }
  }
}

}  // namespace
}  // namespace curbstone::mapper
