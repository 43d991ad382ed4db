#include <gtest/gtest.h>

#include <map>

#include <algorithm>

#include "tests/services/mapper/mapper_drive.hpp"

namespace curbstone::mapper::dense_map {
namespace {

using test::MapperDrive;
using test::SyntheticWorld;
using Box = test::SyntheticWorld::Box;

/// Straight along the street at 3 m/s, from x = -14.
Pose along_the_street(double t) {
  return test::pose(-14 + 3 * t, 0, 0, 0, 0, 0);
}

/// A car of 4.2 m with its middle at (x, y), a hand above the ground, and its wheels.
std::vector<Box> car(double x, double y) {
  std::vector<Box> boxes{{{x - 2.1, y - 0.9, 0.2}, {x + 2.1, y + 0.9, 0.9}},
                         {{x - 1.3, y - 0.8, 0.9}, {x + 1, y + 0.8, 1.45}}};
  for (const double dx : {-1.3, 1.3}) boxes.push_back({{x + dx - 0.3, y - 0.9, 0}, {x + dx + 0.3, y + 0.9, 0.3}});
  return boxes;
}

/// Points of the dense map in a box of the world.
int points_in(const DenseMap& dense, const Pose& T_world_map, const Box& box) {
  int count = 0;
  for (const TileKey& key : dense.keys()) {
    const DenseTile& tile = *dense.tile(key);
    for (const TilePoint& p : tile.read()->points()) {
      const Eigen::Vector3d in_map(key.x * kTileSize + p.x * kPositionStep, key.y * kTileSize + p.y * kPositionStep,
                                   tile.z_origin() + p.z * kPositionStep);
      const Eigen::Vector3d q = T_world_map * in_map;
      count += (q.array() >= box.low.array()).all() && (q.array() <= box.high.array()).all();
    }
  }
  return count;
}
int points_in(test::MapperDrive& drive, const Box& box) {
  return points_in(drive.dense(), drive.T_world_map, box);
}

/// A drive along the street whose boxes may change as it goes; `boxes(t)` are there besides the street's.
struct ChangingStreet : test::MapperDrive {
  explicit ChangingStreet(std::function<std::vector<Box>(double)> more, double free_range = 12.0)
      : boxes(std::move(more)), fixed(world.boxes) {
    trajectory = along_the_street;
    config.dense.free_range = free_range;
    mapper.emplace(config);
    with_odometry(20);
  }
  void until(double t) {
    for (; turn * test::kPeriod < t;) {
      world.boxes = fixed;
      for (const Box& box : boxes(turn * test::kPeriod)) world.boxes.push_back(box);
      (void)step();
      if (pauses && turn % 3 != 0) mapper->begin_free_space_removal();
    }
  }
  bool pauses = false;
  [[nodiscard]] std::int64_t removed() { return dense().counters()["dense.removed"]; }
  std::function<std::vector<Box>(double)> boxes;
  std::vector<Box> fixed;
};

TEST(FreeSpace, ACarThatKeepsUpWithUsLeavesNoSmear) {
  const auto beside = [](double t) { return t < 6 ? car(-10 + 2.7 * t, 3.2) : std::vector<Box>{}; };
  const Box lane{{-9, 2.2, 0.08}, {5, 4.0, 1.6}};
  ChangingStreet without(beside, 0), with(beside);
  for (ChangingStreet* drive : {&without, &with}) drive->until(9);
  const int smear = points_in(without, lane);
  EXPECT_GT(smear, 2000) << "this is what must fade";
  EXPECT_LT(points_in(with, lane), smear / 20);
  EXPECT_GT(with.removed(), smear * 9 / 10);
}

TEST(FreeSpace, WhatHasLeftIsTakenOutTheSameWayWheneverThereIsTimeToLook) {
  const auto parked = [](double t) { return t < 2 ? car(-1, -3.2) : std::vector<Box>{}; };
  ChangingStreet busy(parked), idle(parked);
  idle.pauses = true;
  for (ChangingStreet* drive : {&busy, &idle}) drive->until(5);
  EXPECT_GT(busy.removed(), 100);
  EXPECT_EQ(busy.removed(), idle.removed());
  const DenseMap& a = busy.dense();
  const DenseMap& b = idle.dense();
  ASSERT_EQ(a.keys(), b.keys());
  for (const TileKey& key : a.keys()) {
    EXPECT_TRUE(a.tile(key)->read()->records == b.tile(key)->read()->records) << key.x << " " << key.y;
  }
}

TEST(FreeSpace, AtTheEndOfTheDriveNothingThatWasTakenOutIsLeftUnreported) {
  const auto parked = [](double t) { return t < 2 ? car(-1, -3.2) : std::vector<Box>{}; };
  ChangingStreet watched(parked), drive(parked);
  const auto one_more = [](ChangingStreet& street) { street.until((street.turn + 0.5) * test::kPeriod); };
  while (watched.removed() < 100) one_more(watched);
  std::map<TileKey, std::size_t> reported;
  const auto tell = [&](const std::vector<TileKey>& changed) {
    for (const TileKey& key : changed) reported[key] = drive.mapper->grown().tile(key)->num_records();
  };
  while (drive.turn < watched.turn) {
    one_more(drive);
    drive.mapper->wait_inserted();
    tell(drive.mapper->take_changed());
  }
  tell(drive.mapper->finish());
  EXPECT_EQ(drive.removed(), watched.removed()) << "by the last look";
  const DenseMap& dense = drive.dense();
  for (const TileKey& key : dense.keys()) EXPECT_EQ(reported[key], dense.tile(key)->num_records());
}

TEST(FreeSpace, AParkedCarThatLeavesFadesAndItsPlaceIsGround) {
  const auto parked = [](double t) { return t < 4 ? car(-1, -3.2) : std::vector<Box>{}; };
  const Box place{{-3.2, -4.2, 0.06}, {1.2, -2.2, 1.6}};
  ChangingStreet drive(parked);
  drive.until(3.9);
  const int before = points_in(drive, place);
  EXPECT_GT(before, 500);
  drive.until(9);
  EXPECT_LT(points_in(drive, place), before / 20);
  EXPECT_GT(points_in(drive, {{-3.2, -4.2, -0.1}, {1.2, -2.2, 0.06}}), 100);
}

TEST(FreeSpace, ALorryThatPassedBehindTheVehicleFadesWhileItIsStillInSight) {
  // 14 m at 7 m/s: it is in one place for 2 s, longer than `persistence_s`, and the vehicle drives away from it.
  const auto lorry = [](double t) {
    const double x = -2 - 7 * (t - 4.5);
    return std::vector<Box>{{{x - 14, 2.4, 0.3}, {x, 4.6, 2.8}}};
  };
  const Box lane{{-14, 2.2, 0.35}, {2, 4.8, 3}};
  ChangingStreet drive(lorry);
  int most = 0;
  for (double t = 4; t < 9.5; t += 0.1) {
    drive.until(t);
    most = std::max(most, points_in(drive, lane));
  }
  EXPECT_GT(most, 500) << "this is what must fade";
  EXPECT_LT(points_in(drive, lane), most / 10);
}

TEST(FreeSpace, WhatIsThinStaysAndSoDoWallsAndKerbs) {
  std::vector<Box> things{{{-20, 5.9, 0}, {40, 8, 0.12}},      // a pavement with its kerb
                          {{-20, -9, 0}, {40, -7, 0.15}},      //
                          {{0, 2.6, 0}, {0.05, 2.65, 3}},      // a thin pole near the lane
                          {{9, -2.53, 0}, {9.04, -2.5, 1.2}},  // a bollard
                          {{2, -4.05, 0.95}, {8, -4.0, 1.0}},  // a rail on...
                          {{-12, 2.8, 0}, {-7, 3.0, 0.9}}};    // a low wall whose top is seen from above
  for (double x = 2; x <= 8; x += 0.15) things.push_back({{x, -4.04, 0.1}, {x + 0.025, -4.01, 1.0}});  // ...a fence
  ChangingStreet drive([&](double) { return things; });
  drive.until(9);
  EXPECT_GT(points_in(drive, {{1.9, -4.2, 0.08}, {8.2, -3.9, 1.1}}), 500) << "the fence was mapped";
  EXPECT_LT(drive.removed(), drive.dense().size() / 20'000);
}

TEST(FreeSpace, RollingBackBringsBackWhatWasTakenOutAndMovingTheMapForgetsIt) {
  const auto parked = [](double t) { return t < 4 ? car(-1, -3.2) : std::vector<Box>{}; };
  const Box place{{-3.2, -4.2, 0.06}, {1.2, -2.2, 1.6}};
  ChangingStreet drive(parked);
  drive.until(4);
  const int before = points_in(drive, place);
  drive.until(8);
  DenseMap dense = drive.dense();
  ASSERT_LT(points_in(drive, place), before / 10);
  DenseMap begun_anew = dense;
  dense.roll_back(test::utime(4));
  EXPECT_NEAR(points_in(dense, drive.T_world_map, place), before, before / 20);
  EXPECT_EQ(dense.num_removals(), 0);

  begun_anew.move({});
  EXPECT_EQ(begun_anew.num_removals(), 0);
  for (const TileKey& key : begun_anew.keys()) {
    EXPECT_EQ(begun_anew.tile(key)->num_records(), begun_anew.tile(key)->num_points());
  }
}

TEST(FreeSpace, WhatIsDisplacedByDriftIsNotJudged) {
  DenseMap dense{config::DenseConfig{}};
  test::SyntheticWorld world = test::street();
  const Pose T_base_lidar = test::default_lidar();
  const auto snapshot = [&] { return world.snapshot(Pose::Identity(), T_base_lidar); };
  std::int64_t t = test::SyntheticWorld::kEpoch;
  dense.set_anchor(7);
  world.boxes.push_back({{3, -3, 0}, {5, -2, 1.5}});
  for (int i = 0; i < 40; ++i) (void)dense.insert(snapshot(), Pose::Identity(), t += 50'000);
  world.boxes.pop_back();
  const auto look = [&](bool in_place) {
    for (int i = 0; i < 80; ++i) {
      (void)dense.insert({}, Pose::Identity(), t += 50'000);
      (void)dense.clear_free_space(snapshot(), Pose::Identity(), T_base_lidar, {}, t,
                                   [&](std::int32_t anchor) { return in_place || anchor != 7; });
    }
    return dense.num_removals();
  };
  EXPECT_EQ(look(false), 0);
  EXPECT_GT(look(true), 100);
}

TEST(DenseTile, IsTheSameAfterSleepAndGivesBackWhatIsCut) {
  DenseTile tile(0, 25);
  const TilePoint a{10, 20, -30, 1}, b{100, 100, 300, 2}, c{700, 700, 900, 3};
  for (const TilePoint& p : {a, b, c}) tile.append(p, 1'000'000, 0);
  tile.remove({1}, 5'000'000);
  EXPECT_EQ(tile.num_records(), 4u);
  EXPECT_TRUE(is_removal(tile.read()->records[3]));
  EXPECT_TRUE(at_one_place(removal_of(tile.read()->records[3]), b));
  EXPECT_FALSE(tile.occupied(tile.voxel_number(b)));
  tile.append(b, 6'000'000, 0);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(tile.read()->points().size(), 3u);
    EXPECT_EQ(tile.num_points(), 3u);
    EXPECT_FALSE(tile.is_present(1));
    EXPECT_TRUE(tile.is_present(4));
    EXPECT_TRUE(tile.occupied(tile.voxel_number(b)));
    tile.sleep();
    ASSERT_TRUE(tile.wake());
  }
  ASSERT_TRUE(tile.truncate_after(4'500'000));
  ASSERT_TRUE(tile.wake());
  EXPECT_EQ(tile.num_records(), 3u);
  EXPECT_TRUE(tile.is_present(1));
}

TEST(DenseTile, ASetForgetsNumbersAndFindsTheOthers) {
  NumberSet set;
  for (std::uint32_t i = 0; i < 2000; ++i) set.insert(i * 7);
  for (std::uint32_t i = 0; i < 2000; i += 3) set.erase(i * 7);
  set.erase(5);
  for (std::uint32_t i = 0; i < 2000; ++i) EXPECT_EQ(set.contains(i * 7), i % 3 != 0);
}

}  // namespace
}  // namespace curbstone::mapper::dense_map
