#include <gtest/gtest.h>

#include <curbstone/semantic_tile_t.hpp>
#include <map>

#include "common/bus/local_bus.hpp"
#include "services/mapper/mapper_node.hpp"
#include "services/semantic_map/semantic_map_node.hpp"
#include "services/tensor_voting/worker/tensor_voting_node.hpp"
#include "tests/services/mapper/synthetic_world.hpp"

namespace curbstone::semantic_map {
namespace {

constexpr double kPeriod = 0.05;  // s

std::int64_t utime(double t) {
  return test::SyntheticWorld::kEpoch + std::llround(t * 1e6);
}

/// Along the street at 3 m/s; odometry says the same, and map is where the drive begins.
Pose driving(double t) {
  return test::pose(-14 + 3 * t, 0, 0, 0, 0, 0);
}

odometry_t odometry_at(double t) {
  odometry_t m{};
  m.utime = utime(t);
  m.flags = odometry_t::INITIALISED;
  pose_to_arrays(driving(0).inverse() * driving(t), m.position, m.orientation);
  return m;
}

/// The mapper, a worker and the semantic map on one bus, on a drive beside a car that is as fast until it has gone.
class CarBeside {
 public:
  explicit CarBeside(double free_range) {
    mapper::config::MapperConfig mapper_config;
    mapper_config.dense.free_range = free_range;
    mapper::MapperNode mapper(mapper_config, bus_);
    const tensor_voting::worker::TensorVotingConfig voting_config;
    tensor_voting::worker::TensorVotingNode voting(voting_config, "tensor_voting:1", bus_);
    SemanticMapConfig map;
    map.map.clear();
    SemanticMapNode semantic(map, bus_);
    nodes_ = {&mapper, &voting, &semantic};
    for (Node* node : nodes_) node->connect(bus_);
    bus_.subscribe<semantic_tile_t>("SEMANTIC_TILE", [&](const semantic_tile_t& m) {
      tiles_[{m.tile_x, m.tile_y}] = m;
    });
    for (int turn = 0; turn * kPeriod < 9; ++turn) drive(turn);
    for (Node* node : nodes_) {
      node->finish();
      bus_.dispatch();
    }
  }

  /// Cells of a class (or worse) in a rectangle of the world.
  [[nodiscard]] int cells(double x0, double y0, double x1, double y1, int at_least, int at_most) const {
    const Eigen::Vector3d start = driving(0).translation();
    int count = 0;
    for (const auto& [key, tile] : tiles_) {
      for (int i = 0; i < tile::kCellsInTile; ++i) {
        const double x = key.x * kTileSize + (i % kCellsPerTile + 0.5) * kCellSize + start.x();
        const double y = key.y * kTileSize + (i / kCellsPerTile + 0.5) * kCellSize;
        const int c = tile.cell_class[i];
        count += x > x0 && x < x1 && y > y0 && y < y1 && c >= at_least && c <= at_most ? 1 : 0;
      }
    }
    return count;
  }

 private:
  void drive(int turn) {
    const double t = turn * kPeriod;
    test::SyntheticWorld world = test::street();
    world.noise = 0.01;
    const double x = -10 + 2.7 * t;
    if (t < 6) world.boxes.push_back({{x - 2.1, 2.3, 0.2}, {x + 2.1, 3.9, 1.45}});
    for (const lidar_points_t& packet : world.packets(driving, test::default_lidar(), turn, t, kPeriod)) {
      for (; utime(next_odometry_) <= packet.utime + 10'000; next_odometry_ += 0.01)
        bus_.publish("ODOMETRY", odometry_at(next_odometry_));
      bus_.publish("LIDAR_POINTS", packet);
      bus_.dispatch();
      if (packet.utime < next_tick_) continue;
      next_tick_ = packet.utime + 20'000;
      for (Node* node : nodes_) {
        node->tick(packet.utime);
        bus_.dispatch();
      }
    }
  }

  LocalBus bus_;
  std::vector<Node*> nodes_;
  std::map<TileKey, semantic_tile_t> tiles_;
  double next_odometry_ = -0.1;
  std::int64_t next_tick_ = 0;
};

TEST(Fading, TheSemanticMapFollowsAndTheLaneIsRoadAgain) {
  const CarBeside without(0), with(12);
  constexpr int kRoad = static_cast<int>(tile::CellClass::kRoad),
                kObstacle = static_cast<int>(tile::CellClass::kObstacle),
                kWall = static_cast<int>(tile::CellClass::kWall);
  const auto blocked = [](const CarBeside& map) { return map.cells(-9, 2.1, 5, 3.95, kObstacle, kWall); };
  const auto road = [](const CarBeside& map) { return map.cells(-9, 2.1, 5, 3.95, kRoad, kRoad); };
  EXPECT_GT(blocked(without), 200) << "the smear of a car that was never there for long";
  EXPECT_LT(blocked(with), blocked(without) / 20);
  EXPECT_GT(road(with), road(without));
  const auto fronts = [](const CarBeside& map) { return map.cells(-14, 7.9, 12, 8.3, kWall, kWall); };
  EXPECT_GT(fronts(with), 150);
  EXPECT_NEAR(fronts(with), fronts(without), 3) << "what stands there stays";
}

}  // namespace
}  // namespace curbstone::semantic_map
