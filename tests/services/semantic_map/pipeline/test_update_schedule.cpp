#include "services/semantic_map/pipeline/update_schedule.hpp"

#include <gtest/gtest.h>

namespace curbstone::semantic_map::pipeline {
namespace {

constexpr std::int64_t kNow = 1'700'000'000'000'000;
constexpr std::int64_t kTick = 20'000;
constexpr double kPlenty = 1000;  // of work a tick
const Eigen::Vector2d kVehicle(0, 0);

/// A tile so many points of which came in one step; it had so many before.
VotedChange voted(TileKey key, std::size_t points, std::size_t points_before = 0) {
  return {.key = key, .revision = 1, .utime = kNow, .points_before = points_before, .points = points};
}

TileWork show(int x) {
  return {TileWork::Kind::kUpdateColumns, {x, 0}};
}

TileWork update(int x) {
  return {TileWork::Kind::kUpdate, {x, 0}};
}

const TileWork kSettle{TileWork::Kind::kOldestStep};
const Backlog kNothingStale{};

TEST(UpdateSchedule, ShowsOneTileAtATimeInTheOrderInWhichTheyChanged) {
  UpdateSchedule schedule(kPlenty);
  for (const int x : {5, 1, 3}) schedule.voted(voted({x, 0}, 500), kNow);
  schedule.voted(voted({1, 0}, 600, 500), kNow);  // once more, before it was shown
  for (const int x : {5, 1, 3}) EXPECT_EQ(schedule.next_to_show(), show(x));
  EXPECT_FALSE(schedule.next_to_show());
  EXPECT_EQ(schedule.num_waiting(), 3U) << "their curbs are still to be looked for";
}

TEST(UpdateSchedule, WhatWasBroughtUpToDateNeedNotBeShown) {
  UpdateSchedule schedule(kPlenty);
  schedule.voted(voted({0, 0}, 500), kNow);
  EXPECT_EQ(schedule.next_work(kVehicle, kNothingStale, kNow), update(0));
  EXPECT_FALSE(schedule.next_to_show());
  EXPECT_EQ(schedule.num_waiting(), 0U);
}

TEST(UpdateSchedule, LooksForCurbsNearTheVehicleFirst) {
  UpdateSchedule schedule(kPlenty);
  for (const int x : {-20, 2, 11}) schedule.voted(voted({x, 0}, 500), kNow);
  for (const int x : {2, 11, -20}) EXPECT_EQ(schedule.next_work(kVehicle, kNothingStale, kNow + kTick), update(x));
}

TEST(UpdateSchedule, LooksForCurbsFirstWhereMostPointsWaitForWhatTheyCost) {
  UpdateSchedule schedule(kPlenty);
  const auto again = [&](int x, double cost, std::int64_t now) {
    VotedChange change = voted({x, 0}, 500);
    change.update_cost = cost;
    schedule.voted(change, now);
  };
  // Of tiles that lie one beside the other: costly, cheap, and costly with three steps that wait.
  again(0, 6, kNow);
  again(1, 1, kNow);
  for (int step = 0; step < 3; ++step) again(2, 6, kNow);
  for (const int x : {1, 2, 0}) EXPECT_EQ(schedule.next_work(kVehicle, kNothingStale, kNow + kTick), update(x));
}

TEST(UpdateSchedule, NothingWaitsForMuchMoreThanASecond) {
  UpdateSchedule schedule(1.0);
  VotedChange far = voted({30, 0}, 1010, 1000);
  far.update_cost = 10;
  schedule.voted(far, kNow);
  std::int64_t now = kNow;
  for (bool is_served = false; !is_served; now += kTick) {
    ASSERT_LE(now, kNow + 1'100'000);
    for (int x = 0; x < 20; ++x) schedule.voted(voted({x, 0}, 500), now);  // near, cheap and without end
    while (const auto work = schedule.next_work(kVehicle, kNothingStale, now)) {
      schedule.spent(0.5);
      is_served = is_served || *work == update(30);
    }
  }
  EXPECT_GT(now, kNow + 900'000) << "but what is cheap and near comes first";
}

TEST(UpdateSchedule, AFewNewPointsWaitForOthersButNotForLong) {
  UpdateSchedule schedule(kPlenty);
  schedule.voted(voted({0, 0}, 1000), kNow);
  EXPECT_TRUE(schedule.next_work(kVehicle, kNothingStale, kNow));
  const std::int64_t later = kNow + 100'000;
  schedule.voted(voted({0, 0}, 1010, 1000), later);
  EXPECT_FALSE(schedule.next_work(kVehicle, kNothingStale, later));
  EXPECT_EQ(schedule.next_to_show(), show(0)) << "what stands there is shown at once";
  EXPECT_FALSE(schedule.next_work(kVehicle, kNothingStale, later + 140'000));
  EXPECT_EQ(schedule.next_work(kVehicle, kNothingStale, later + 150'000), update(0));
}

TEST(UpdateSchedule, ManySmallStepsAreALargeOneTogether) {
  UpdateSchedule schedule(kPlenty);
  schedule.voted(voted({0, 0}, 1100, 1000), kNow);
  EXPECT_FALSE(schedule.next_work(kVehicle, kNothingStale, kNow));
  schedule.voted(voted({0, 0}, 1500, 1100), kNow);
  EXPECT_EQ(schedule.next_work(kVehicle, kNothingStale, kNow), update(0));
}

TEST(UpdateSchedule, WorksNoMoreThanItsBudgetAllows) {
  UpdateSchedule schedule(1.0);  // a tile's evidence, about, each tick
  for (int x = 0; x < 40; ++x) schedule.voted(voted({3 * x, 0}, 500), kNow);
  const auto worked_at = [&](std::int64_t now) {
    int tiles = 0;
    for (; schedule.next_work(kVehicle, kNothingStale, now); ++tiles) schedule.spent(1.4);
    return tiles;
  };
  EXPECT_EQ(worked_at(kNow), 2) << "no more is saved up than a revolution's time";
  int tiles = 0;
  for (int tick = 1; tick <= 10; ++tick) tiles += worked_at(kNow + tick * kTick);
  EXPECT_GE(tiles, 6);
  EXPECT_LE(tiles, 8);
  EXPECT_LE(worked_at(kNow + 3'600'000'000), 2) << "nor after an hour";
  EXPECT_EQ(worked_at(kNow), 0) << "and a clock that jumps back brings nothing";
}

TEST(UpdateSchedule, SettlesWhatHasBeenStaleForASecond) {
  UpdateSchedule schedule(kPlenty);
  EXPECT_FALSE(schedule.next_work(kVehicle, {.turn = 7, .oldest = 5}, kNow));
  EXPECT_FALSE(schedule.next_work(kVehicle, {.turn = 9, .oldest = 5}, kNow + 500'000));
  EXPECT_EQ(schedule.next_work(kVehicle, {.turn = 9, .oldest = 5}, kNow + 1'000'000), kSettle);
  EXPECT_EQ(schedule.next_work(kVehicle, {.turn = 9, .oldest = 7}, kNow + 1'000'000), kSettle);
  EXPECT_FALSE(schedule.next_work(kVehicle, {.turn = 9, .oldest = 8}, kNow + 1'000'000));
  EXPECT_EQ(schedule.next_work(kVehicle, {.turn = 9, .oldest = 8}, kNow + 1'500'000), kSettle);
  EXPECT_FALSE(schedule.next_work(kVehicle, {.turn = 9}, kNow + 1'600'000)) << "nothing is stale";
}

TEST(UpdateSchedule, WhatIsStaleGetsItsShareThoughNewsNeverEnds) {
  UpdateSchedule schedule(8);
  const Backlog stale{.turn = 5, .oldest = 5};
  double settled = 0;
  double all = 0;
  for (std::int64_t now = kNow; now < kNow + 10'000'000; now += kTick) {
    for (int x = 0; x < 40; ++x) schedule.voted(voted({x, 0}, 500), now);
    while (const auto work = schedule.next_work(kVehicle, stale, now)) {
      const double cost = *work == kSettle ? 0.05 : 1.7;
      schedule.spent(cost);
      all += cost;
      if (*work == kSettle) settled += cost;
    }
  }
  EXPECT_GT(settled, 0.08 * all);
  EXPECT_LT(settled, 0.11 * all) << "nor does it hold back the news";
}

TEST(UpdateSchedule, ForgetsTheEpochBefore) {
  UpdateSchedule schedule(kPlenty);
  schedule.voted(voted({0, 0}, 500), kNow);
  schedule.clear();
  EXPECT_FALSE(schedule.next_to_show());
  EXPECT_FALSE(schedule.next_work(kVehicle, kNothingStale, kNow));
  EXPECT_EQ(schedule.num_waiting(), 0U);
}

}  // namespace
}  // namespace curbstone::semantic_map::pipeline
