#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "services/mapper/dense_map/dense_map.hpp"
#include "tests/services/mapper/dense_map/ground_patch.hpp"

namespace curbstone::mapper::dense_map {
namespace {

/// A map of ground along a drive of 20 m; each 5 m have an anchor of their own.
DenseMap anchored_drive() {
  DenseMap map{config::DenseConfig{}};
  for (int anchor = 0; anchor < 4; ++anchor) {
    map.set_anchor(anchor);
    for (int i = 0; i < 3; ++i) {
      (void)map.insert(patch(5.0 * anchor, 0, 0.01), Pose::Identity(), kStart + 10'000'000 * anchor + kPeriod * i);
    }
  }
  return map;
}

TEST(DenseMap, StaysBitForBitWhenNodesDoNotMove) {
  DenseMap map = anchored_drive();
  const auto before = all_points(map);
  map.move(std::vector<Pose>(4, Pose::Identity()));
  EXPECT_EQ(all_points(map), before);
  EXPECT_EQ(map.size(), static_cast<std::int64_t>(before.size()));
}

TEST(DenseMap, PointsMoveWithTheNodeTheyWereSeenFrom) {
  DenseMap map = anchored_drive();
  const std::int64_t size = map.size();
  std::vector<Pose> corrections(4, Pose::Identity());
  corrections[2].translation() = Eigen::Vector3d(0, 7.5, 1.0);
  map.move(corrections);
  EXPECT_EQ(map.size(), size);
  int moved = 0;
  for (const Eigen::Vector3d& p : all_points(map)) {
    const bool of_second = std::abs(p.x() - 10) < 0.6;
    EXPECT_NEAR(p.y(), of_second ? 7.5 : 0.0, 0.52);
    EXPECT_NEAR(p.z(), of_second ? 1.01 : 0.01, 0.003);
    moved += of_second ? 1 : 0;
  }
  EXPECT_NEAR(moved, static_cast<int>(size) / 4, 1);
}

TEST(DenseMap, WhatLiesFarFromTheVehicleSleepsWhenTheNodesHaveMoved) {
  DenseMap map{config::DenseConfig{}};
  std::vector<Pose> corrections;
  for (int anchor = 0; anchor < 40; ++anchor) {
    const Pose T = Pose(Eigen::Translation3d(10.0 * anchor, 0, 0));
    map.set_anchor(anchor);
    for (int i = 0; i < 3; ++i) (void)map.insert(patch(0, 0, 0.01), T, kStart + 10'000'000 * anchor + kPeriod * i);
    corrections.push_back(Pose(Eigen::Translation3d(0.02 * anchor, 0.2 * anchor, 0)));
  }
  const std::int64_t size = map.size();
  map.move(corrections);
  EXPECT_EQ(map.size(), size);
  for (const TileKey& key : map.keys()) {
    const double ahead = key.x * kTileSize - 390;  // of the vehicle
    if (ahead > -63 && ahead < -57) continue;
    EXPECT_EQ(map.tile(key)->asleep(), ahead < -60) << key.x << "," << key.y;
  }
}

/// A street to the east, `tiles` long, of 2000 points a tile: each tile with a node of its own.
DenseMap street(int tiles) {
  DenseMap map{config::DenseConfig{}};
  for (int x = 0; x < tiles; ++x) {
    std::vector<TilePoint> records;
    for (int i = 0; i < 2000; ++i) {
      records.push_back(
          {static_cast<std::int16_t>(12 + 25 * (i % 50)), static_cast<std::int16_t>(12 + 25 * (i / 50)), 0, 1});
    }
    map.restore({x, 0}, 0, {std::move(records), {{x, 0, kStart + x}}}, Eigen::Vector3d::Zero());
  }
  return map;
}

TEST(DenseMap, ALongDriveMovesBitByBitThoseTilesFirstThatAreNearTheVehicle) {
  DenseMap map = street(400);
  const std::int64_t size = map.size();
  map.move(std::vector<Pose>(400, Pose(Eigen::Translation3d(0, 0, 1))));
  ASSERT_TRUE(map.is_moving());
  EXPECT_GT(map.size(), 250'000) << "what the vehicle needs next is there";
  EXPECT_LT(map.size(), 400'000) << "and no pose waits for the rest";
  EXPECT_NE(map.tile({100, 0}), nullptr);
  EXPECT_EQ(map.tile({399, 0}), nullptr);
  std::vector<TileKey> told = map.keys();
  for (int scan = 0; map.is_moving(); ++scan) {
    ASSERT_LT(scan, 10);
    for (const TileKey& key : map.insert({}, Pose::Identity(), kStart + kPeriod * scan)) told.push_back(key);
  }
  EXPECT_EQ(map.size(), size);
  EXPECT_EQ(told, map.keys()) << "nearest first, and each tile was told of once it was there";
  for (const TileKey& key : map.keys()) {
    ASSERT_EQ(map.tile(key)->num_points(), 2000U);
    EXPECT_EQ(map.tile(key)->read()->records.front().z, 500) << "1 m";
  }
}

TEST(DenseMap, FinishesWhatStillMoves) {
  DenseMap map = street(400);
  const std::int64_t size = map.size();
  map.move(std::vector<Pose>(400, Pose::Identity()));
  const std::vector<TileKey> told = map.finish();
  EXPECT_FALSE(map.is_moving());
  EXPECT_EQ(map.size(), size);
  EXPECT_NE(std::find(told.begin(), told.end(), TileKey{399, 0}), told.end());
}

TEST(DenseMap, ASecondCorrectionMovesEveryPointByBoth) {
  DenseMap map = street(400);
  const std::vector<Pose> up(400, Pose(Eigen::Translation3d(0, 0, 1)));
  map.move(up);
  map.move(up);
  (void)map.finish();
  EXPECT_EQ(map.size(), 800'000);
  for (const TileKey& key : map.keys()) EXPECT_EQ(map.tile(key)->read()->records.front().z, 1000) << key.x;
}

TEST(DenseMap, WhereTwoPassesComeTogetherAVoxelKeepsOnePoint) {
  DenseMap map = anchored_drive();
  const std::int64_t one = map.size() / 4;
  std::vector<Pose> corrections(4, Pose::Identity());
  for (int anchor = 1; anchor < 4; ++anchor)
    corrections[static_cast<std::size_t>(anchor)].translation().x() = -5.0 * anchor;
  map.move(corrections);
  EXPECT_EQ(map.size(), one);
}

TEST(DenseMap, GoesOnGrowingAfterItsNodesWereMoved) {
  DenseMap map = anchored_drive();
  std::vector<Pose> corrections(4, Pose::Identity());
  corrections[3].translation().y() = 0.5;
  map.move(corrections);
  const std::int64_t size = map.size();
  for (int i = 0; i < 3; ++i) (void)map.insert(patch(0, 0, 0.01), Pose::Identity(), kStart + 50'000'000 + kPeriod * i);
  EXPECT_EQ(map.size(), size) << "these voxels have their points";
  for (int i = 0; i < 3; ++i) (void)map.insert(patch(0, 9, 0.01), Pose::Identity(), kStart + 60'000'000 + kPeriod * i);
  EXPECT_GT(map.size(), size);
}

TEST(DenseMap, RollingBackGivesTheMapOfThatTime) {
  DenseMap map = anchored_drive();
  map.roll_back(kStart + 15'000'000);
  for (const Eigen::Vector3d& p : all_points(map)) EXPECT_LT(p.x(), 6);
  EXPECT_EQ(map.size(), static_cast<std::int64_t>(all_points(map).size()));
  const std::int64_t size = map.size();
  for (int i = 0; i < 3; ++i) (void)map.insert(patch(15, 0, 0.01), Pose::Identity(), kStart + 50'000'000 + kPeriod * i);
  EXPECT_EQ(map.size(), size * 3 / 2) << "what was given up can be mapped again";
}

TEST(DenseMap, ALoadedTileIsThereAndMovesNoMore) {
  DenseMap map{config::DenseConfig{}};
  DenseMap other = anchored_drive();
  for (const TileKey& key : other.keys()) {
    const DenseTile& tile = *other.tile(key);
    map.load(key, tile.z_origin(), tile.utime(), tile.read()->points());
  }
  EXPECT_EQ(all_points(map), all_points(other));
  Pose away = Pose::Identity();
  away.translation().x() = 30;
  map.move(std::vector<Pose>(4, away));
  EXPECT_EQ(all_points(map), all_points(other));
}

}  // namespace
}  // namespace curbstone::mapper::dense_map
