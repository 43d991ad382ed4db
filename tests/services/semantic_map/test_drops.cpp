#include <gtest/gtest.h>

#include "tests/services/mapper/synthetic_world.hpp"
#include "tests/services/semantic_map/synthetic_ground.hpp"

namespace curbstone::semantic_map {
namespace {

using test::SyntheticWorld;

/// Slabs of ground with their tops at z; the vehicle's street runs along x.
test::SyntheticWorld::Box slab(double x0, double y0, double x1, double y1, double z) {
  return {{x0, y0, z - 3}, {x1, y1, z}};
}

/// What sixteen beams see of a world from a vehicle that drives from x = -8 to 8 at y = 0.
detect::cloud_map::CloudMap drive_through(const std::vector<test::SyntheticWorld::Box>& boxes,
                                          cells::ClassParameters classes = {}) {
  test::SyntheticWorld world;
  world.ground = false;
  world.boxes = boxes;
  SyntheticCloud cloud;
  for (double x = -8; x <= 8; x += 0.1) {
    const Pose T = test::pose(x, 0, 0, 0, 0, 0);
    for (const mapper::scan::LidarPoint& p : world.snapshot(T, test::default_lidar())) {
      const Eigen::Vector3d q = T * p.position.cast<double>();
      if (std::abs(q.x()) < 10 && std::abs(q.y()) < 8) cloud.add(q.x(), q.y(), q.z());
    }
  }
  detect::cloud_map::CloudMapOptions options;
  options.classes = classes;
  return map_of(cloud, options);
}

struct Costs {
  int cells = 0, lethal = 0, paid = 0, free = 0;
};

/// Of the cells of a rectangle; `paid`: they cost, or are not known.
Costs costs_in(const detect::cloud_map::CloudMap& map, double x0, double y0, double x1, double y1) {
  Costs costs;
  for (const tile::MapTile& tile : map.tiles) {
    for (std::size_t i = 0; i < tile::kCellsInTile; ++i) {
      const double x = tile.key.x * kTileSize + (static_cast<double>(i % kCellsPerTile) + 0.5) * kCellSize;
      const double y = tile.key.y * kTileSize + (static_cast<double>(i / kCellsPerTile) + 0.5) * kCellSize;
      if (x < x0 || x > x1 || y < y0 || y > y1) continue;
      ++costs.cells;
      costs.lethal += tile.cost[i] == 254 ? 1 : 0;
      costs.paid += tile.cost[i] > 0 ? 1 : 0;
      costs.free += tile.cost[i] == 0 ? 1 : 0;
    }
  }
  return costs;
}

std::vector<test::SyntheticWorld::Box> street_with_pit(double depth, double x0, double y0, double x1, double y1) {
  return {slab(-40, -40, 40, y0, 0), slab(-40, y1, 40, 40, 0), slab(-40, y0, x0, y1, 0), slab(x1, y0, 40, y1, 0),
          slab(x0, y0, x1, y1, -depth)};
}

TEST(Drops, APitCostsWhereverItIsSeen) {
  for (const double depth : {0.3, 0.6, 1.2}) {
    const detect::cloud_map::CloudMap map = drive_through(street_with_pit(depth, -0.8, 2.2, 0.8, 3.8));
    const Costs pit = costs_in(map, -0.75, 2.3, 0.75, 3.75);
    EXPECT_LT(pit.free, pit.cells / 10) << depth << ": nobody drives into it";
    const Costs rim = costs_in(map, -1, 2.1, 1, 4);
    EXPECT_GT(rim.lethal, 20) << depth << ": its far walls at least, 3 m of them";
    const Costs road = costs_in(map, -4, -1, 4, 1.5);
    EXPECT_EQ(road.lethal, 0) << depth;
  }
}

TEST(Drops, AKerbThatGoesDownCostsAsOneThatGoesUp) {
  const detect::cloud_map::CloudMap down = drive_through({slab(-40, -40, 40, 3, 0), slab(-40, 3, 40, 40, -0.12)});
  const detect::cloud_map::CloudMap up = drive_through({slab(-40, -40, 40, 3, 0), slab(-40, 3, 40, 40, 0.12)});
  for (const detect::cloud_map::CloudMap* map : {&down, &up}) {
    int crossings = 0, paid = 0;
    for (double x = -5; x < 5; x += 0.12, ++crossings) paid += costs_in(*map, x, 2.6, x + 0.12, 3.6).paid > 0 ? 1 : 0;
    EXPECT_GT(paid, crossings * 95 / 100) << (map == &down ? "down" : "up");
    EXPECT_EQ(costs_in(*map, -5, -1, 5, 2).paid, 0);
  }
  int from_below = 0;
  for (const detect::cloud_map::CloudCurb& c : down.curbs) from_below += c.up.y() < -0.9 ? 1 : 0;
  EXPECT_GT(from_below, 50) << "and it is known to go down";
}

TEST(Drops, AnEdgeThatIsTooHighToGoDownIsLethal) {
  const detect::cloud_map::CloudMap map = drive_through({slab(-40, -40, 40, 3, 0), slab(-40, 3, 40, 40, -0.35)});
  int crossings = 0, lethal = 0;
  for (double x = -5; x < 5; x += 0.12, ++crossings) lethal += costs_in(map, x, 2.4, x + 0.12, 4.2).lethal > 0 ? 1 : 0;
  EXPECT_GT(lethal, crossings * 9 / 10);
}

}  // namespace
}  // namespace curbstone::semantic_map
