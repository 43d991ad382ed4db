#include "services/mapper/dense_map/dense_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/services/mapper/dense_map/ground_patch.hpp"

namespace curbstone::mapper::dense_map {
namespace {

/// A box's side, from z = 0.3 m up, at distance x.
std::vector<scan::LidarPoint> side(double x, double low = 0.35, double high = 1.4) {
  std::vector<scan::LidarPoint> points;
  for (double y = -0.6; y < 0.6; y += 0.04) {
    for (double z = low; z < high; z += 0.1) points.push_back({Eigen::Vector3d(x, y, z).cast<float>(), 0, 50, 0});
  }
  return points;
}

std::vector<scan::LidarPoint> operator+(std::vector<scan::LidarPoint> a, const std::vector<scan::LidarPoint>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// How many of its points are higher than z, m.
int num_above(const DenseMap& map, double z) {
  const std::vector<Eigen::Vector3d> points = all_points(map);
  return static_cast<int>(std::count_if(points.begin(), points.end(), [&](const auto& p) { return p.z() > z; }));
}

/// The drive goes on elsewhere for so many revolutions, and ends.
void drive_away(DenseMap& map, std::int64_t since, int revolutions) {
  for (int i = 1; i <= revolutions; ++i) (void)map.insert({}, Pose::Identity(), since + i * kPeriod);
  (void)map.finish();
}

TEST(DenseMap, TakesIntensitiesOnTheScaleGivenAndNoneForNothing) {
  intensity::RingHistograms seen{10, {{}}};
  for (std::size_t i = 0; i < 9; ++i) seen.rings[0][26 + i] = 100;
  DenseMap map{config::DenseConfig{}};
  map.set_scale(std::make_shared<const intensity::RingTable>(seen));
  const auto point = [](float x, std::uint8_t intensity, std::uint8_t ring) {
    return scan::LidarPoint{{x, 1.01F, 0.01F}, 0, intensity, ring};
  };
  const std::vector<std::vector<scan::LidarPoint>> scans = {
      {point(4.01F, 30, 0), point(4.21F, 30, 1)},
      {point(4.01F, 0, 0), point(4.21F, 30, 1)},  // of ring 1 nothing is known
      {point(4.01F, 30, 0), point(4.21F, 30, 1)}};
  std::int64_t utime = kStart;
  for (const auto& points : scans) map.insert(points, Pose::Identity(), utime += kPeriod);
  const std::vector<TilePoint> points = map.tile(*tile_at(4.01, 1.01))->read()->points();
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[0].intensity, 64) << "the mean of the hits that had one";
  EXPECT_EQ(points[1].intensity, 0);
  EXPECT_EQ(map.counters()["dense.without_intensity"], 1);
}

TEST(DenseMap, GivesOnePointAVoxelOnceItHasBeenHitThreeTimes) {
  DenseMap map{config::DenseConfig{}};
  const auto ground = patch(5, 5, 0.01);
  EXPECT_TRUE(map.insert(ground, Pose::Identity(), kStart).empty());
  EXPECT_TRUE(map.insert(ground, Pose::Identity(), kStart + kPeriod).empty());
  EXPECT_FALSE(map.insert(ground, Pose::Identity(), kStart + 2 * kPeriod).empty());
  std::set<std::array<int, 3>> voxels;
  for (const Eigen::Vector3d& p : all_points(map)) {
    EXPECT_TRUE(voxels
                    .insert({static_cast<int>(std::floor(p.x() / 0.05 + 1e-6)),
                             static_cast<int>(std::floor(p.y() / 0.05 + 1e-6)),
                             static_cast<int>(std::floor(p.z() / 0.05 + 1e-6))})
                    .second);
  }
  EXPECT_GT(voxels.size(), 350u);
  EXPECT_EQ(static_cast<std::int64_t>(voxels.size()), map.size());
}

TEST(DenseMap, APointIsTheMeanOfItsHits) {
  DenseMap map{config::DenseConfig{}};
  const double heights[] = {0.012, 0.020, 0.034};
  for (int i = 0; i < 3; ++i) {
    (void)map.insert(
        {{{4.025F, 4.025F, static_cast<float>(heights[i])}, 0, static_cast<std::uint8_t>(30 * (i + 1)), 0}},
        Pose::Identity(), kStart + i * kPeriod);
  }
  const auto points = all_points(map);
  ASSERT_EQ(points.size(), 1u);
  EXPECT_NEAR(points[0].z(), 0.022, 0.002);
  EXPECT_EQ(map.tile(*tile_at(4.0, 4.0))->read()->points()[0].intensity, 60);
}

TEST(DenseMap, AVoxelHitOnceGoesInAfterAWhile) {
  DenseMap map{config::DenseConfig{}};
  (void)map.insert(patch(5, 5, 0), Pose::Identity(), kStart);
  std::int64_t t = kStart;
  while (t < kStart + 250'000) (void)map.insert({}, Pose::Identity(), t += kPeriod);
  EXPECT_EQ(map.size(), 0);
  (void)map.insert({}, Pose::Identity(), kStart + 300'000);
  EXPECT_GT(map.size(), 350);
}

TEST(DenseMap, OnlyEverAppendsAndRepetitionChangesNothing) {
  DenseMap map{config::DenseConfig{}};
  std::int64_t t = kStart;
  for (int i = 0; i < 4; ++i) (void)map.insert(patch(5, 5, 0), Pose::Identity(), t += kPeriod);
  const auto before = all_points(map);
  for (int i = 0; i < 40; ++i) EXPECT_TRUE(map.insert(patch(5, 5, 0), Pose::Identity(), t += kPeriod).empty());
  EXPECT_EQ(all_points(map), before);
  const TileKey key = *tile_at(5, 5);
  const std::vector<TilePoint> tile = map.tile(key)->read()->points();
  for (int i = 0; i < 4; ++i) (void)map.insert(patch(5.2, 5.1, 0), Pose::Identity(), t += kPeriod);
  const std::vector<TilePoint>& grown = map.tile(key)->read()->points();
  ASSERT_GT(grown.size(), tile.size());
  for (std::size_t i = 0; i < tile.size(); ++i) {
    EXPECT_EQ(grown[i].x, tile[i].x);
    EXPECT_EQ(grown[i].y, tile[i].y);
    EXPECT_EQ(grown[i].z, tile[i].z);
  }
}

TEST(DenseMap, WhatStandsAboveGroundGoesInOnceItHasStayed) {
  DenseMap map{config::DenseConfig{}};
  std::int64_t t = kStart;
  for (; t <= kStart + 900'000; t += kPeriod) (void)map.insert(patch(5, 0, 0, 2) + side(5), Pose::Identity(), t);
  for (const Eigen::Vector3d& p : all_points(map)) EXPECT_LT(p.z(), 0.3);
  for (; t <= kStart + 1'300'000; t += kPeriod) (void)map.insert(patch(5, 0, 0, 2) + side(5), Pose::Identity(), t);
  EXPECT_GT(num_above(map, 0.3), 200);
}

TEST(DenseMap, WhatPassesByLeavesNoGhostNorItsWheels) {
  DenseMap map{config::DenseConfig{}};
  std::int64_t t = kStart;
  // A car 3 m long at 5 m/s along x, 4 m to the left: it hides the ground that it is over.
  for (int i = 0; i < 60; ++i, t += kPeriod) {
    const double front = -8 + 5.0 * 0.05 * i;
    std::vector<scan::LidarPoint> seen;
    for (double x = -8; x < 8; x += 0.04) {
      const bool behind = x > front - 3 && x < front;
      if (!behind) {
        for (double y = 3; y < 6; y += 0.1) seen.push_back({Eigen::Vector3d(x, y, 0).cast<float>(), 0, 9, 0});
        continue;
      }
      for (double y = 3; y < 4; y += 0.1) seen.push_back({Eigen::Vector3d(x, y, 0).cast<float>(), 0, 9, 0});
      for (double z = 0.12; z < 1.4; z += 0.12) seen.push_back({Eigen::Vector3d(x, 4, z).cast<float>(), 0, 9, 0});
    }
    (void)map.insert(seen, Pose::Identity(), t);
  }
  drive_away(map, t, 80);
  EXPECT_EQ(num_above(map, 0.05), 0) << "ghosts";
  EXPECT_GT(map.counters()["dense.transient"], 100);
  EXPECT_GT(map.size(), 1000);  // the road is there
}

TEST(DenseMap, ABumperSeenInTwoLinesLeavesNeither) {
  DenseMap map{config::DenseConfig{}};
  std::int64_t t = kStart;
  // Sixteen beams: of the car that follows the vehicle at 3 m/s a line at 0.24 m and one at 0.5 m.
  for (int i = 0; i < 40; ++i, t += kPeriod) {
    const double front = -14 + 3.0 * 0.05 * i;
    std::vector<scan::LidarPoint> seen = patch(front + 1, 0, 0, 2);
    for (double y = -0.8; y < 0.8; y += 0.05) {
      for (const double z : {0.24, 0.5}) seen.push_back({Eigen::Vector3d(front, y, z).cast<float>(), 0, 9, 0});
    }
    (void)map.insert(seen, Pose::Identity(), t);
  }
  drive_away(map, t, 200);
  EXPECT_EQ(num_above(map, 0.05), 0) << "ghosts";
  EXPECT_GT(map.size(), 1000);  // the road is there
}

TEST(DenseMap, WhatIsLowGoesInAsSoonAsWhatWasAboveItHasPassed) {
  DenseMap map{config::DenseConfig{}};
  std::int64_t t = kStart;
  const std::vector<scan::LidarPoint> road = patch(5, 0, 0, 2), kerb = patch(5, 0, 0.12, 0.3);
  for (int i = 0; i < 4; ++i) (void)map.insert(road + side(5), Pose::Identity(), t += kPeriod);  // somebody steps over
  for (int i = 0; i < 40; ++i) (void)map.insert(road + kerb, Pose::Identity(), t += kPeriod);
  EXPECT_EQ(num_above(map, 0.1), 36);
}

TEST(DenseMap, KeepsToItsRangeAndHeights) {
  DenseMap map{config::DenseConfig{}};
  for (int i = 0; i < 4; ++i) {
    (void)map.insert(patch(25, 0, 0) + patch(5, 0, -4) + patch(5, 0, 6), Pose::Identity(), kStart + i * kPeriod);
  }
  (void)map.finish();
  EXPECT_EQ(map.size(), 0);
}

TEST(DenseMap, AddsNothingNewWhenToldNotTo) {
  DenseMap map{config::DenseConfig{}};
  for (int i = 0; i < 4; ++i) (void)map.insert(patch(5, 0, 0), Pose::Identity(), kStart + i * kPeriod, false);
  EXPECT_EQ(map.size(), 0);
}

TEST(DenseMap, GivesUpTheFarthestTilesWhenItIsFull) {
  config::DenseConfig config;
  config.max_points = 3000;
  DenseMap map{config};
  std::int64_t t = kStart;
  for (int i = 0; i < 700; ++i) {
    Pose T = Pose::Identity();
    T.translation().x() = 0.5 * i;
    (void)map.insert(patch(3, 0, 0, 1.0, 0.08), T, t += kPeriod);
  }
  EXPECT_GT(map.counters()["dense.evicted_tiles"], 10);
  EXPECT_FALSE(map.take_evicted().empty());
  EXPECT_EQ(map.tile({0, 0}), nullptr);
  EXPECT_NE(map.tile(*tile_at(350, 0)), nullptr);
}

TEST(DenseMap, ATileThatSleptKnowsItsVoxelsWhenItWakes) {
  DenseTile tile(0, 25);
  const TilePoint a{10, 20, -30, 1}, b{1499, 1499, 32000, 2}, c{0, 0, -32000, 3};
  for (const TilePoint& p : {a, b, c}) tile.append(p, kStart, 0);
  tile.sleep();
  ASSERT_TRUE(tile.wake());
  for (const TilePoint& p : {a, b, c}) EXPECT_TRUE(tile.occupied(tile.voxel_number(p)));
  EXPECT_FALSE(tile.occupied(tile.voxel_number({10, 20, 30, 1})));
  EXPECT_EQ(tile.read()->points().size(), 3u);
}

/// A vehicle that is far away for a while.
void drive_elsewhere(DenseMap& map, std::int64_t& t) {
  Pose far = Pose::Identity();
  far.translation().x() = 200;
  for (int i = 0; i < 100; ++i) (void)map.insert(patch(3, 0, 0), far, t += kPeriod);
}

TEST(DenseMap, KnownGroundDoesNotGetThickerWithEachVisit) {
  DenseMap map{config::DenseConfig{}};
  std::int64_t t = kStart;
  const auto visit = [&](double z) {
    for (int i = 0; i < 10; ++i) (void)map.insert(patch(3, 0, z, 4.0), Pose::Identity(), t += kPeriod);
  };
  visit(0.01);
  const std::size_t once = map.tile({1, 0})->num_points() + map.tile({0, 0})->num_points();
  visit(0.06);
  const std::size_t thick = map.tile({1, 0})->num_points() + map.tile({0, 0})->num_points();
  EXPECT_EQ(thick, 2 * once) << "in one visit whatever is seen is a point, a voxel each";
  drive_elsewhere(map, t);
  for (const double z : {-0.04, 0.11}) visit(z);
  EXPECT_EQ(map.tile({1, 0})->num_points() + map.tile({0, 0})->num_points(), thick);
}

TEST(DenseMap, WhatIsNewOnKnownGroundIsMappedAsAnywhere) {
  DenseMap map{config::DenseConfig{}};
  std::int64_t t = kStart;
  for (int i = 0; i < 10; ++i) (void)map.insert(patch(3, 0, 0.01, 1.0), Pose::Identity(), t += kPeriod);
  drive_elsewhere(map, t);
  const std::int64_t before = map.size();
  // A box 0.35 m above the ground that was there, and ground beyond it.
  for (int i = 0; i < 40; ++i) (void)map.insert(side(3) + patch(6, 0, 0.01, 1.0), Pose::Identity(), t += kPeriod);
  DenseMap fresh{config::DenseConfig{}};
  for (int i = 0; i < 40; ++i) (void)fresh.insert(side(3) + patch(6, 0, 0.01, 1.0), Pose::Identity(), t += kPeriod);
  EXPECT_EQ(map.size() - before, fresh.size());
}

TEST(DenseMap, AGapInKnownGroundIsFilledUpToAVoxelFromItsEdge) {
  DenseMap map{config::DenseConfig{}};
  std::int64_t t = kStart;
  for (int i = 0; i < 10; ++i)
    (void)map.insert(patch(2.5, 0, 0.01, 1.0) + patch(4.5, 0, 0.01, 1.0), Pose::Identity(), t += kPeriod);
  drive_elsewhere(map, t);
  const std::int64_t before = map.size();
  for (int i = 0; i < 10; ++i) (void)map.insert(patch(3.5, 0, 0.01, 1.0), Pose::Identity(), t += kPeriod);
  EXPECT_EQ(map.size() - before, 20 * 18) << "across the border of two tiles";
}

TEST(DenseMap, ATileThatSleepsHoldsItsRecordsAndNothingElse) {
  DenseTile tile(0, 25);
  for (int i = 0; i < 3600; ++i) {
    tile.append({static_cast<std::int16_t>(i % 60 * 25), static_cast<std::int16_t>(i / 60 * 25), 0, 1}, kStart, 0);
  }
  const std::size_t awake = tile.bytes();
  tile.sleep();
  EXPECT_EQ(tile.bytes(), 3600 * sizeof(TilePoint) + sizeof(DenseTile::Run));
  EXPECT_LT(2 * tile.bytes(), awake);
}

}  // namespace
}  // namespace curbstone::mapper::dense_map
