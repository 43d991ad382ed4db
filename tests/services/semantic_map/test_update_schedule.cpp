#include "services/semantic_map/update_schedule.hpp"

#include <gtest/gtest.h>

#include <set>

namespace curbstone {
namespace {

constexpr std::int64_t kNow = 1'700'000'000'000'000;
constexpr std::int64_t kTick = 20'000;
constexpr double kPlenty = 1000;  // of work a tick
const Eigen::Vector2d kVehicle(0, 0);

class UpdateScheduleTest : public testing::Test {
 protected:
  /// A tile of so many points on flat ground comes.
  void voted(UpdateSchedule& schedule, TileKey key, std::size_t points, std::int64_t now = kNow) {
    const VotedTile* const before = pipeline.voted(key);
    const std::size_t points_before = before == nullptr ? 0 : before->points.size();
    VotedTile tile;
    tile.key = key;
    tile.utime = now;
    for (std::size_t i = 0; i < points; ++i) {
      VotedPoint p;
      p.x = static_cast<float>(i % 60) * 0.05F;
      p.y = static_cast<float>(i / 60 % 60) * 0.05F;
      tile.points.push_back(p);
    }
    pipeline.set_voted(std::move(tile), points_before > 0);
    schedule.changed(key, points_before, now);
  }
  /// The tiles that have become others since the last call.
  std::set<TileKey> changed() { return pipeline.take_changed(); }

  TilePipeline pipeline{{}, {}};
};

TEST_F(UpdateScheduleTest, ShowsOneTileAtATimeInTheOrderInWhichTheyChanged) {
  UpdateSchedule schedule(kPlenty, pipeline);
  for (const int x : {5, 1, 3}) voted(schedule, {x, 0}, 500);
  voted(schedule, {1, 0}, 600);  // once more, before it was shown
  for (const int x : {5, 1, 3}) {
    EXPECT_TRUE(schedule.show_one());
    EXPECT_EQ(changed(), (std::set<TileKey>{{x, 0}}));
  }
  EXPECT_FALSE(schedule.show_one());
  EXPECT_EQ(schedule.num_waiting(), 3U) << "their curbs are still to be looked for";
}

TEST_F(UpdateScheduleTest, WhatWasBroughtUpToDateNeedNotBeShown) {
  UpdateSchedule schedule(kPlenty, pipeline);
  voted(schedule, {0, 0}, 500);
  EXPECT_TRUE(schedule.work_on_one(kVehicle, kNow));
  EXPECT_EQ(changed().size(), 1U);
  EXPECT_FALSE(schedule.show_one());
  EXPECT_EQ(schedule.num_waiting(), 0U);
}

TEST_F(UpdateScheduleTest, LooksForCurbsNearTheVehicleFirst) {
  UpdateSchedule schedule(kPlenty, pipeline);
  for (const int x : {20, 2, 11}) voted(schedule, {x, 0}, 500);
  for (const int x : {2, 11, 20}) {
    EXPECT_TRUE(schedule.work_on_one(kVehicle, kNow));
    EXPECT_EQ(changed(), (std::set<TileKey>{{x, 0}}));
  }
}

TEST_F(UpdateScheduleTest, AFewNewPointsWaitForOthersButNotForLong) {
  UpdateSchedule schedule(kPlenty, pipeline);
  voted(schedule, {0, 0}, 1000);
  EXPECT_TRUE(schedule.work_on_one(kVehicle, kNow));
  const std::int64_t later = kNow + 100'000;
  voted(schedule, {0, 0}, 1010, later);
  EXPECT_FALSE(schedule.work_on_one(kVehicle, later));
  EXPECT_TRUE(schedule.show_one()) << "what stands there is shown at once";
  EXPECT_FALSE(schedule.work_on_one(kVehicle, later + 400'000));
  EXPECT_TRUE(schedule.work_on_one(kVehicle, later + 500'000));
}

TEST_F(UpdateScheduleTest, WorksNoMoreThanItsBudgetAllows) {
  UpdateSchedule schedule(1.0, pipeline);  // a tile's evidence, about, each tick
  for (int x = 0; x < 40; ++x) voted(schedule, {3 * x, 0}, 500);
  const auto worked_at = [&](std::int64_t now) {
    int tiles = 0;
    while (schedule.work_on_one(kVehicle, now)) ++tiles;
    return tiles;
  };
  EXPECT_LE(worked_at(kNow), 3) << "no more is saved up than a revolution's time";
  int tiles = 0;
  for (int tick = 1; tick <= 10; ++tick) tiles += worked_at(kNow + tick * kTick);
  EXPECT_GE(tiles, 5);
  EXPECT_LE(tiles, 10);
  EXPECT_LE(worked_at(kNow + 3'600'000'000), 3) << "nor after an hour";
  EXPECT_EQ(worked_at(kNow), 0) << "and a clock that jumps back brings nothing";
}

TEST_F(UpdateScheduleTest, BringsUpToDateWhatHasLongBeenStaleThoughNothingCameToIt) {
  UpdateSchedule schedule(kPlenty, pipeline);
  voted(schedule, {0, 0}, 500);
  EXPECT_TRUE(schedule.work_on_one(kVehicle, kNow));
  voted(schedule, {1, 0}, 500, kNow);  // its neighbour must look at the new ground
  EXPECT_TRUE(schedule.work_on_one(kVehicle, kNow));
  EXPECT_GT(pipeline.num_stale(), 0U);
  EXPECT_FALSE(schedule.work_on_one(kVehicle, kNow + 500'000));
  std::int64_t now = kNow + 500'000;
  for (int tick = 0; tick < 100; ++tick) {
    while (schedule.work_on_one(kVehicle, now)) continue;
    now += kTick;
  }
  EXPECT_EQ(pipeline.num_stale(), 0U);
}

TEST_F(UpdateScheduleTest, ForgetsTheEpochBefore) {
  UpdateSchedule schedule(kPlenty, pipeline);
  voted(schedule, {0, 0}, 500);
  pipeline.clear();
  schedule.clear();
  EXPECT_FALSE(schedule.show_one());
  EXPECT_FALSE(schedule.work_on_one(kVehicle, kNow));
  EXPECT_EQ(schedule.num_waiting(), 0U);
}

}  // namespace
}  // namespace curbstone
