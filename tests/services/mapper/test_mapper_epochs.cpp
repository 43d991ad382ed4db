#include <gtest/gtest.h>

#include <curbstone/map_points_t.hpp>
#include <curbstone/map_pose_t.hpp>
#include <curbstone/map_trajectory_t.hpp>
#include <filesystem>
#include <map>

#include "common/bus/local_bus.hpp"
#include "services/mapper/mapper_node.hpp"
#include "services/mapper/storage/map_folder.hpp"
#include "tests/services/mapper/mapper_drive.hpp"

namespace curbstone::mapper {
namespace {

using test::kPeriod;
using test::utime;

test::SyntheticWorld distinct_street() {
  test::SyntheticWorld world = test::street();
  world.noise = 0.01;
  world.boxes.push_back({{-16, 3, 0}, {-13, 6, 3}});
  world.boxes.push_back({{2, -8, 0}, {4, -6, 2.2}});
  return world;
}

/// What a listener has of the newest epoch, and all that it heard of the drive.
struct Listener {
  std::int32_t epoch = 0;
  std::map<TileKey, std::vector<TilePoint>> tiles;
  std::vector<map_pose_t> poses;
  std::vector<map_trajectory_t> pages;
  bool gap = false;

  explicit Listener(LocalBus& bus) {
    bus.subscribe<map_points_t>("MAP_POINTS", [this](const map_points_t& m) { on(m); });
    bus.subscribe<map_pose_t>("MAP_POSE", [this](const map_pose_t& m) { poses.push_back(m); });
    bus.subscribe<map_trajectory_t>("MAP_TRAJECTORY", [this](const map_trajectory_t& m) { pages.push_back(m); });
  }
  void on(const map_points_t& m) {
    if (m.epoch > epoch) tiles.clear();
    epoch = std::max(epoch, m.epoch);
    if (m.epoch < epoch) return;
    std::vector<TilePoint>& points = tiles[{m.tile_x, m.tile_y}];
    gap = gap || m.first > static_cast<std::int32_t>(points.size());
    for (auto i = points.size() - static_cast<std::size_t>(m.first); i < m.x.size(); ++i) {
      points.push_back({m.x[i], m.y[i], m.z[i], m.intensity[i]});
    }
  }
};

struct EpochBench {
  LocalBus bus;
  MapperNode node;
  Listener listener{bus};
  double odometry_sent = -0.1;
  int turn = 0;

  explicit EpochBench(const config::MapperConfig& config = {}) : node(config, bus) { node.connect(bus); }
  /// One revolution of a world from a place, with the odometry of the true drive.
  void step(const test::SyntheticWorld& world, const test::SyntheticWorld::Trajectory& trajectory) {
    const int n = turn++;
    for (; odometry_sent < (n + 1) * test::kPeriod + 0.02; odometry_sent += 0.01) {
      odometry_t m{};
      m.utime = test::utime(odometry_sent);
      m.flags = odometry_t::INITIALISED;
      pose_to_arrays(test::driving(0).inverse() * test::driving(odometry_sent), m.position, m.orientation);
      bus.publish("ODOMETRY", m);
    }
    for (const lidar_points_t& packet : world.packets(trajectory, config::MapperConfig{}.vehicle.T_base_lidar(), n,
                                                      n * test::kPeriod, test::kPeriod)) {
      bus.publish("LIDAR_POINTS", packet);
    }
    bus.dispatch();
    for (int i = 0; i < 2; ++i) node.tick(test::utime(n * test::kPeriod + 0.02 * i));
    bus.dispatch();
  }
  void drive(int turns) {
    for (int i = 0; i < turns; ++i) step(distinct_street(), test::driving);
  }
  void finish() {
    node.finish();
    bus.dispatch();
  }
  void expect_listener_has_the_map() const {
    EXPECT_FALSE(listener.gap);
    std::size_t points = 0;
    for (const auto& [key, heard] : listener.tiles) {
      const dense_map::DenseTile* tile = node.mapper().dense().tile(key);
      ASSERT_TRUE(tile != nullptr) << key.x << ' ' << key.y;
      ASSERT_EQ(heard.size(), tile->num_points());
      points += heard.size();
    }
    EXPECT_EQ(static_cast<std::int64_t>(points), node.mapper().dense().size());
  }
};

TEST(MapperEpochs, AMapThatWasRolledBackGoesOutAnewWithTheDriveSoFar) {
  EpochBench bench;
  bench.drive(40);
  test::SyntheticWorld frozen = distinct_street();
  frozen.boxes.push_back({{-1, 2.5, 0}, {5, 3.5, 3}});
  for (int i = 0; i < 40; ++i) bench.step(frozen, [](double) { return test::driving(40 * test::kPeriod); });
  const std::int32_t before = bench.listener.epoch;
  bench.drive(90);
  bench.finish();
  EXPECT_GT(bench.listener.epoch, before);
  bench.expect_listener_has_the_map();

  ASSERT_FALSE(bench.listener.pages.empty());
  const map_trajectory_t& page = bench.listener.pages.front();
  EXPECT_EQ(page.num_pages, static_cast<std::int32_t>(bench.listener.pages.size()));
  EXPECT_EQ(page.epoch, bench.listener.epoch);
  ASSERT_GT(page.num_poses, 20);
  EXPECT_TRUE(std::is_sorted(page.utimes.begin(), page.utimes.end()));
  const Pose T_world_map = test::driving(test::kPeriod) * Pose::Identity();
  for (int i = 0; i < page.num_poses; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double t = static_cast<double>(page.utimes[k] - test::SyntheticWorld::kEpoch) * 1e-6;
    const Eigen::Vector3d p(page.positions[k][0], page.positions[k][1], page.positions[k][2]);
    EXPECT_LT((T_world_map * p - test::driving(t).translation()).norm(), 0.05) << "nothing of the false drive is in it";
  }
  bool was_lost = false;
  for (const map_pose_t& pose : bench.listener.poses) was_lost = was_lost || (pose.flags & map_pose_t::LOST) != 0;
  EXPECT_TRUE(was_lost);
  EXPECT_EQ(bench.listener.poses.back().flags & map_pose_t::LOST, 0);
}

TEST(MapperEpochs, AMapIsKeptAndGoneOnWithInAHigherEpoch) {
  const auto folder = std::filesystem::temp_directory_path() / ("curbstone-epochs-" + std::to_string(getpid()));
  std::filesystem::remove_all(folder);
  config::MapperConfig config;
  config.folder = folder.string();
  EpochBench first(config);
  first.drive(40);
  first.finish();
  const storage::SavedMap kept = storage::load_map(folder);
  EXPECT_EQ(kept.epoch, first.listener.epoch);

  config.mode = config::MapMode::kExtend;
  EpochBench second(config);
  second.drive(60);
  second.finish();
  EXPECT_GT(second.listener.epoch, first.listener.epoch);
  second.expect_listener_has_the_map();
  EXPECT_GT(storage::load_map(folder).tiles.size(), kept.tiles.size());
  EXPECT_TRUE(second.node.report().faults.empty());

  config.mode = config::MapMode::kLocalise;
  const auto written = std::filesystem::last_write_time(folder / "map.yaml");
  EpochBench third(config);
  third.drive(40);
  third.finish();
  third.expect_listener_has_the_map();
  EXPECT_EQ(std::filesystem::last_write_time(folder / "map.yaml"), written) << "only used";
  std::filesystem::remove_all(folder);
}

TEST(MapperEpochs, AMapIsKeptWhileDrivingAndNobodyNotices) {
  const auto folder = std::filesystem::temp_directory_path() / ("curbstone-kept-" + std::to_string(getpid()));
  std::filesystem::remove_all(folder);
  config::MapperConfig config;
  config.folder = folder.string();
  config.save_every = 0.5;
  EpochBench kept(config);
  EpochBench plain;
  std::size_t tiles = 0;
  for (int i = 0; i < 4; ++i) {
    kept.drive(20);
    plain.drive(20);
    while (kept.node.report().counters["folder.saved"] <= i) kept.node.tick(test::utime(100 + i));
    const storage::SavedMap found = storage::load_map(folder);
    EXPECT_GE(found.tiles.size(), tiles);
    EXPECT_FALSE(found.nodes.empty());
    tiles = found.tiles.size();
  }
  EXPECT_GT(tiles, 10U);
  kept.finish();
  plain.finish();
  const storage::SavedMap found = storage::load_map(folder);
  const storage::SavedMap expected = kept.node.mapper().saved(kept.listener.epoch);  // all of it, at once
  ASSERT_EQ(found.tiles.size(), expected.tiles.size());
  for (std::size_t i = 0; i < found.tiles.size(); ++i) {
    const storage::SavedTile& a = found.tiles[i];
    const storage::SavedTile& b = expected.tiles[i];
    ASSERT_TRUE(a.key == b.key && a.utime == b.utime && a.points.size() == b.points.size()) << i;
    for (std::size_t k = 0; k < a.points.size(); ++k)
      ASSERT_TRUE(a.points[k].x == b.points[k].x && a.points[k].y == b.points[k].y && a.points[k].z == b.points[k].z);
  }
  ASSERT_EQ(found.nodes.size(), expected.nodes.size());
  for (std::size_t i = 0; i < found.nodes.size(); ++i) EXPECT_EQ(found.nodes[i].points, expected.nodes[i].points);
  EXPECT_EQ(found.edges.size(), expected.edges.size());
  ASSERT_EQ(kept.listener.poses.size(), plain.listener.poses.size());
  for (std::size_t i = 0; i < kept.listener.poses.size(); ++i) {
    for (int k = 0; k < 3; ++k)
      EXPECT_EQ(kept.listener.poses[i].map_base_position[k], plain.listener.poses[i].map_base_position[k]);
  }
  std::filesystem::remove_all(folder);
}

TEST(MapperEpochs, AMapThatCannotBeUsedStopsTheProcessAtOnce) {
  config::MapperConfig config;
  config.mode = config::MapMode::kExtend;
  config.folder = "/nowhere/at/all";
  LocalBus bus;
  EXPECT_THROW(MapperNode(config, bus), storage::MapFolderError);
}

TEST(MapperEpochs, AMapThatCannotBeWrittenIsAFault) {
  config::MapperConfig config;
  config.folder = "/proc/curbstone";
  EpochBench bench(config);
  bench.drive(10);
  bench.finish();
  EXPECT_EQ(bench.node.report().counters["faults.folder"], 1);
  EXPECT_FALSE(bench.node.report().faults.empty());
}

}  // namespace
}  // namespace curbstone::mapper
