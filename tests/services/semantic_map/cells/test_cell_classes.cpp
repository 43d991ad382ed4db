#include "services/semantic_map/cells/cell_classes.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "tests/services/semantic_map/synthetic_ground.hpp"

namespace curbstone::semantic_map::cells {
namespace {

constexpr double kDensity = 250;  // points a square metre

TEST(Classes, AWallIsAWallABoxAnObstacleAndACrownNeither) {
  SyntheticCloud cloud;
  cloud.ground(0, 0, 12, 12, kDensity, [](double, double) { return 0.0; });
  cloud.face(0, 10.5, 12, 10.5, 0, 3, 400);
  cloud.box(3, 3, 3.5, 3.5, 0, 0.8, 1500);
  for (int i = 0; i < 6000; ++i) cloud.add(cloud.uniform(7, 9), cloud.uniform(3, 5), cloud.uniform(2.4, 4));
  const detect::cloud_map::CloudMap map = map_of(cloud);
  EXPECT_EQ(class_at(map, 6, 10.5), tile::CellClass::kWall);
  EXPECT_EQ(class_at(map, 3.24, 3.0), tile::CellClass::kObstacle);
  EXPECT_EQ(class_at(map, 8, 4), tile::CellClass::kRoad) << "what hangs above the vehicle does not block";
  EXPECT_EQ(class_at(map, 6, 6), tile::CellClass::kRoad);
  for (const detect::cloud_map::CloudCurb& c : map.curbs) ADD_FAILURE() << "a curb at " << c.foot.transpose();
}

TEST(Classes, AVehicleBlocksAllOfItsOutlineThoughTheGroundBeneathItIsSeen) {
  SyntheticCloud cloud;  // body 4.2 x 1.8 m, seen from below y = 4; light gets under it, its roof is out of sight
  cloud.ground(-6, -3, 12, 12, kDensity, [](double, double) { return 0.0; });
  cloud.face(2, 4, 6.2, 4, 0.25, 0.85, 400);
  cloud.face(2, 4, 2, 5.8, 0.25, 0.85, 400);
  cloud.face(6.2, 4, 6.2, 5.8, 0.25, 0.85, 400);
  cloud.face(3, 4.1, 5.2, 4.1, 0.85, 1.45, 400);
  const detect::cloud_map::CloudMap map = map_of(cloud);
  for (const double x : {2.4, 3.5, 5.0, 5.8}) {
    EXPECT_EQ(class_at(map, x, 4.5), tile::CellClass::kWall) << x << ": beneath";
    EXPECT_EQ(class_at(map, x, 4.0), tile::CellClass::kWall) << x << ": bonnet and doors are of the vehicle";
    EXPECT_EQ(class_at(map, x, 3.5), tile::CellClass::kRoad) << x << ": beside";
    EXPECT_EQ(class_at(map, x, 6.3), tile::CellClass::kRoad) << x << ": behind";
  }
}

TEST(Classes, TheCornerOfALongWallIsNoVehicle) {
  SyntheticCloud cloud;
  cloud.ground(-3, -3, 12, 12, kDensity, [](double, double) { return 0.0; });
  cloud.face(1, 1, 9, 1, 0, 1.5, 400);
  cloud.face(1, 1, 1, 9, 0, 1.5, 400);
  const detect::cloud_map::CloudMap map = map_of(cloud);
  EXPECT_EQ(class_at(map, 1.5, 1.5), tile::CellClass::kRoad) << "who is inside the corner can drive there";
  EXPECT_EQ(class_at(map, 5, 1), tile::CellClass::kWall);
}

TEST(Classes, APointOnTheEdgeOfACellBlocksBothAndASingleOneOnlyBesideOthers) {
  const ClassParameters parameters;
  tile::Around<CellColumns> around;
  auto columns = std::make_unique<CellColumns>();
  const auto put = [&](int column, int row, const CellColumn& cell) {
    const auto i = static_cast<std::size_t>(row * kCellsPerTile + column);
    columns->cells[i] = cell;
    columns->standing.set(i);
  };
  columns->cells.fill({.points = 5, .ground_points = 5});
  put(5, 5, {.points = 5, .ground_points = 5, .blocking_points = 4, .top = 0.5F, .at_edge = {0, 2, 0, 0}});
  put(5, 6, {.points = 5, .ground_points = 5, .blocking_points = 1});    // beside it
  put(20, 20, {.points = 5, .ground_points = 5, .blocking_points = 1});  // alone
  around.set(0, 0, columns.get());
  tile::MapTile tile;
  classify_cells(around, {}, {}, parameters, tile);
  const auto class_of = [&](int column, int row) {
    return tile.cell_class[static_cast<std::size_t>(row * kCellsPerTile + column)];
  };
  EXPECT_EQ(class_of(5, 5), tile::CellClass::kObstacle);
  EXPECT_EQ(class_of(6, 5), tile::CellClass::kObstacle);
  EXPECT_EQ(class_of(4, 5), tile::CellClass::kRoad);
  EXPECT_EQ(class_of(5, 6), tile::CellClass::kObstacle);
  EXPECT_EQ(class_of(20, 20), tile::CellClass::kRoad);
}

TEST(Classes, StraysOfAWallOverOpenGroundAreNoObstacleThoughTimeAddsToThem) {
  const ClassParameters parameters;
  tile::Around<CellColumns> around;
  auto columns = std::make_unique<CellColumns>();
  columns->cells.fill({.points = 5, .ground_points = 5});
  const auto put = [&](int column, int row, const CellColumn& cell) {
    const auto i = static_cast<std::size_t>(row * kCellsPerTile + column);
    columns->cells[i] = cell;
    columns->standing.set(i);
  };
  constexpr std::uint16_t kStrays = 3;
  for (int column = 0; column < kCellsPerTile; ++column)
    put(column, 10, {.points = 200, .ground_points = 6, .blocking_points = 150, .top = 1.9F});
  put(4, 11, {.points = 8, .ground_points = 5, .blocking_points = kStrays, .top = 1.5F});
  put(12, 11, {.points = 3, .ground_points = 0, .blocking_points = kStrays, .top = 1.5F});
  put(20, 20, {.points = 8, .ground_points = 5, .blocking_points = kStrays, .top = 0.5F});
  around.set(0, 0, columns.get());
  tile::MapTile tile;
  classify_cells(around, {}, {}, parameters, tile);
  const auto class_of = [&](int column, int row) {
    return tile.cell_class[static_cast<std::size_t>(row * kCellsPerTile + column)];
  };
  EXPECT_EQ(class_of(4, 10), tile::CellClass::kWall);
  EXPECT_EQ(class_of(4, 11), tile::CellClass::kRoad) << "one in fifty of the wall's points";
  EXPECT_EQ(class_of(12, 11), tile::CellClass::kObstacle) << "no ground was seen there";
  EXPECT_EQ(class_of(20, 20), tile::CellClass::kObstacle) << "a post of its own";
}

TEST(Classes, WhatWasNotSeenIsUnknownAndTheSafePolicyDoesNotEnterIt) {
  SyntheticCloud cloud;
  cloud.ground(0, 0, 5, 9, kDensity, [](double, double) { return 0.0; });
  cloud.ground(7, 0, 9, 9, kDensity, [](double, double) { return 0.0; });
  const detect::cloud_map::CloudMap map = map_of(cloud);
  EXPECT_EQ(class_at(map, 5.9, 4), tile::CellClass::kUnknown);
  const ClassParameters safe;
  ClassParameters paper;
  paper.unknown_is_free = true;
  EXPECT_EQ(traversal_cost(tile::CellClass::kUnknown, 0, safe), 255);
  EXPECT_EQ(traversal_cost(tile::CellClass::kUnknown, 0, paper), 0);
  EXPECT_EQ(traversal_cost(tile::CellClass::kRoad, 0, safe), 0);
  EXPECT_EQ(traversal_cost(tile::CellClass::kWall, 0, safe), 254);
  EXPECT_EQ(traversal_cost(tile::CellClass::kCurb, 0.30, safe), 254) << "higher than the vehicle may climb";
  ASSERT_EQ(safe.max_step, 0.15);
  EXPECT_EQ(traversal_cost(tile::CellClass::kCurb, 0, safe), 60);
  EXPECT_EQ(traversal_cost(tile::CellClass::kCurb, 0.05, safe), 106) << "60 + 140 / 3";
  EXPECT_EQ(traversal_cost(tile::CellClass::kCurb, 0.14999, safe), 199);
  EXPECT_EQ(traversal_cost(tile::CellClass::kCurb, 0.15001, safe), 254);
}

}  // namespace
}  // namespace curbstone::semantic_map::cells
