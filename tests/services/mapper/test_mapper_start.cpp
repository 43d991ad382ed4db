#include <gtest/gtest.h>

#include <algorithm>
#include <curbstone/map_points_t.hpp>
#include <curbstone/map_pose_t.hpp>
#include <curbstone/map_trajectory_t.hpp>
#include <map>
#include <set>

#include "common/bus/local_bus.hpp"
#include "services/mapper/mapper_node.hpp"
#include "tests/services/mapper/mapper_drive.hpp"

namespace curbstone::mapper {
namespace {

using test::kPeriod;
using Drive = test::MapperDrive;

constexpr double kStands = 2.0;  // s
constexpr int kStandingScans = static_cast<int>(kStands / kPeriod);

Pose after_standing(double t) {
  return test::driving(std::max(0.0, t - kStands));
}

/// Points of a map higher than `z` m.
int points_above(const dense_map::DenseMap& map, double z) {
  int high = 0;
  for (const TileKey& key : map.keys()) {
    const dense_map::DenseTile& tile = *map.tile(key);
    for (const TilePoint& point : tile.read()->points()) high += tile.z_origin() + point.z * kPositionStep > z ? 1 : 0;
  }
  return high;
}

const test::SyntheticWorld::Box kVan{{-4, 1.8, 0}, {-1, 3.2, 2}};

/// Points higher than 0.5 m, of a map whose frame is base_link at the start.
int points_in_van(const dense_map::DenseMap& map) {
  int inside = 0;
  for (const TileKey& key : map.keys()) {
    const dense_map::DenseTile& tile = *map.tile(key);
    for (const TilePoint& p : tile.read()->points()) {
      const Eigen::Vector3d in_world = test::driving(0) * Eigen::Vector3d(key.x * kTileSize + p.x * kPositionStep,
                                                                          key.y * kTileSize + p.y * kPositionStep,
                                                                          tile.z_origin() + p.z * kPositionStep);
      const bool is_in = in_world.x() > kVan.low.x() - 0.1 && in_world.x() < kVan.high.x() + 0.1 &&
                         in_world.y() > kVan.low.y() - 0.1 && in_world.y() < kVan.high.y() + 0.1;
      inside += is_in && in_world.z() > 0.5 ? 1 : 0;
    }
  }
  return inside;
}

TEST(MapperStart, WhatTheStandingVehicleSeesIsShownAndIsNoPartOfTheDrivesMap) {
  Drive drive;
  drive.trajectory = after_standing;
  for (int i = 0; i < kStandingScans - 1; ++i) (void)drive.step();
  drive.mapper->wait();
  EXPECT_TRUE(drive.mapper->shows_start());
  EXPECT_GT(drive.mapper->shown().size(), 1000);
  EXPECT_GT(points_above(drive.mapper->shown(), 1.5), 100) << "what stands, too";
  EXPECT_EQ(drive.mapper->dense().size(), 0);

  std::set<TileKey> of_the_start;
  for (const TileKey& key : drive.mapper->shown().keys()) of_the_start.insert(key);
  int changes = 0;
  for (int i = 0; i < 40; ++i) {
    const auto update = drive.step();
    ASSERT_TRUE(update);
    changes += update->start_is_over ? 1 : 0;
    drive.mapper->wait();
    EXPECT_EQ(drive.mapper->shows_start(), changes == 0) << "until the drive's own map has grown";
    EXPECT_GT(points_above(drive.mapper->shown(), 1.5), 100) << "no less is shown";
  }
  EXPECT_EQ(changes, 1);
  EXPECT_FALSE(drive.mapper->shows_start());
  EXPECT_EQ(&drive.mapper->shown(), &drive.mapper->dense());
}

TEST(MapperStart, WhatStoodThereOnlyBeforeTheVehicleSetOffIsNotInTheDrivesMap) {
  Drive drive;
  drive.trajectory = after_standing;
  drive.world.boxes.push_back(kVan);
  for (int i = 0; i < kStandingScans; ++i) (void)drive.step();
  drive.mapper->wait();
  EXPECT_GT(points_in_van(drive.mapper->shown()), 50);
  drive.world.boxes.pop_back();
  for (int i = 0; i < 40; ++i) (void)drive.step();
  (void)drive.mapper->finish();
  EXPECT_EQ(points_in_van(drive.mapper->shown()), 0);
}

TEST(MapperStart, OnALoadedMapWhatTheStandingVehicleSeesIsAddedOnceItIsFound) {
  Drive first;
  first.trajectory = after_standing;
  for (int i = 0; i < kStandingScans + 60; ++i) (void)first.step();
  (void)first.mapper->finish();
  const storage::SavedMap map = first.mapper->saved(1);

  Drive second;
  second.config.mode = config::MapMode::kExtend;
  second.mapper.emplace(second.config);
  second.mapper->load(map);
  second.trajectory = [](double) { return test::driving(0); };
  second.world.boxes.push_back(kVan);
  int found_at = 0;
  for (int i = 0; i < 80; ++i) {
    const auto update = second.step();
    ASSERT_TRUE(update);
    second.mapper->wait();
    EXPECT_FALSE(second.mapper->shows_start()) << "the loaded map is shown";
    const bool is_found = update->fix == tracking::Fix::kTracking;
    if (is_found && found_at == 0) found_at = i;
    if (!is_found) {
      EXPECT_EQ(points_in_van(second.mapper->shown()), 0) << "nothing of a guess";
    }
  }
  ASSERT_GT(found_at, 0);
  ASSERT_LT(found_at, 40);
  EXPECT_GT(points_in_van(second.mapper->shown()), 50);
  const std::int64_t size = second.mapper->dense().size();
  for (int i = 0; i < 20; ++i) (void)second.step();
  second.mapper->wait();
  EXPECT_LT(second.mapper->dense().size(), size + 50) << "after a while a standing vehicle sees nothing new";
  EXPECT_LT(second.mapper->dense().size(), first.mapper->dense().size() + 4000) << "nor is what is known thickened";
}

TEST(MapperStart, OfADriveThatBeginsOnTheMoveNothingIsHeldBack) {
  Drive drive;
  drive.trajectory = [](double t) { return test::driving(std::max(0.0, t - 0.2)); };
  for (int i = 0; i < 30; ++i) {
    const auto update = drive.step();
    ASSERT_TRUE(update);
    EXPECT_FALSE(update->start_is_over);
    EXPECT_FALSE(drive.mapper->shows_start());
  }
  EXPECT_GT(drive.dense().size(), 1000);
}

TEST(MapperStart, WhatAVehicleThatNeverMovesSeesIsItsMap) {
  for (const double hold : {0.0, 3.0, 30.0}) {
    Drive drive;
    drive.config.dense.start_hold_s = hold;
    drive.mapper.emplace(drive.config);
    drive.trajectory = [](double) { return test::driving(0); };
    for (int i = 0; i < 80; ++i) {
      const auto update = drive.step();
      ASSERT_TRUE(update);
      EXPECT_FALSE(update->start_is_over) << "it stays the map";
    }
    drive.mapper->wait();
    const std::int64_t shown = drive.mapper->shown().size();
    EXPECT_GT(shown, 1000);
    (void)drive.mapper->finish();
    EXPECT_GE(drive.mapper->dense().size(), shown) << hold;
    EXPECT_GT(points_above(drive.mapper->dense(), 1.5), 100) << hold << ": houses are in it";
  }
}

/// A mapper's node, and what a listener has of the newest epoch.
struct StartBench {
  LocalBus bus;
  MapperNode node{config::MapperConfig{}, bus};
  test::SyntheticWorld world = test::street();
  std::map<std::int32_t, std::map<TileKey, std::vector<TilePoint>>> tiles;  // by epoch
  std::map<std::int32_t, std::set<std::int64_t>> poses;                     // likewise, their utimes
  std::set<std::int64_t> all_poses;
  double odometry_sent = -0.1;
  int turn = 0;

  StartBench() {
    world.noise = 0.01;
    node.connect(bus);
    bus.subscribe<map_points_t>("MAP_POINTS", [this](const map_points_t& m) {
      auto& points = tiles[m.epoch][{m.tile_x, m.tile_y}];
      EXPECT_LE(m.first, static_cast<std::int32_t>(points.size()));
      for (auto i = points.size() - static_cast<std::size_t>(m.first); i < m.x.size(); ++i)
        points.push_back({m.x[i], m.y[i], m.z[i], m.intensity[i]});
    });
    bus.subscribe<map_pose_t>("MAP_POSE", [this](const map_pose_t& m) {
      poses[m.epoch].insert(m.utime);
      all_poses.insert(m.utime);
    });
    bus.subscribe<map_trajectory_t>("MAP_TRAJECTORY", [this](const map_trajectory_t& m) {
      for (const std::int64_t utime : m.utimes) poses[m.epoch].insert(utime);
    });
  }
  void drive(int turns) {
    for (int end = turn + turns; turn < end; ++turn) {
      for (; odometry_sent < (turn + 1) * kPeriod + 0.02; odometry_sent += 0.01) {
        odometry_t m{};
        m.utime = test::utime(odometry_sent);
        m.flags = odometry_t::INITIALISED;
        pose_to_arrays(after_standing(0).inverse() * after_standing(odometry_sent), m.position, m.orientation);
        bus.publish("ODOMETRY", m);
      }
      for (const lidar_points_t& packet :
           world.packets(after_standing, test::default_lidar(), turn, turn * kPeriod, kPeriod))
        bus.publish("LIDAR_POINTS", packet);
      bus.dispatch();
      for (int i = 0; i < 2; ++i) node.tick(test::utime(turn * kPeriod + 0.02 * i));
      bus.dispatch();
    }
  }
  void finish() {
    node.finish();
    bus.dispatch();
  }
  void expect_newest_epoch_is_the_drive() const {
    const auto& [epoch, of_tiles] = *tiles.rbegin();
    std::int64_t points = 0;
    for (const auto& [key, heard] : of_tiles) points += static_cast<std::int64_t>(heard.size());
    EXPECT_EQ(points, node.mapper().dense().size());
    EXPECT_EQ(poses.rbegin()->first, epoch);
    EXPECT_EQ(poses.rbegin()->second, all_poses) << "those of the standstill, too";
  }
};

TEST(MapperStart, ListenersSeeTheMapWhileTheVehicleStandsAndTheDrivesOwnInANewEpoch) {
  StartBench bench;
  bench.drive(20);
  ASSERT_EQ(bench.tiles.size(), 1U) << "a second after the first scan there are tiles";
  EXPECT_GT(bench.tiles.begin()->second.size(), 10U);
  bench.drive(kStandingScans - 20 + 10);
  EXPECT_EQ(bench.tiles.size(), 1U) << "setting off";
  bench.drive(40);
  EXPECT_EQ(bench.tiles.size(), 2U);
  bench.finish();
  EXPECT_EQ(bench.tiles.size(), 2U);
  bench.expect_newest_epoch_is_the_drive();
}

TEST(MapperStart, ADriveThatEndsAsItBeginsHasTheMapOfTheDrive) {
  StartBench bench;
  bench.drive(kStandingScans + 10);
  EXPECT_EQ(bench.tiles.size(), 1U);
  bench.finish();
  EXPECT_EQ(bench.tiles.size(), 2U);
  bench.expect_newest_epoch_is_the_drive();
}

TEST(MapperStart, AMapperThatEndsWhileTheVehicleStandsTellsNoOtherMapThanItShowed) {
  StartBench bench;
  bench.drive(kStandingScans - 5);
  bench.finish();
  EXPECT_EQ(bench.tiles.size(), 1U);
  bench.expect_newest_epoch_is_the_drive();
}

}  // namespace
}  // namespace curbstone::mapper
