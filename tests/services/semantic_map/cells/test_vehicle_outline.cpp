#include "services/semantic_map/cells/vehicle_outline.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <utility>

namespace curbstone::semantic_map::cells {
namespace {

using Cells = std::vector<VehicleOutline::Cell>;

/// Cells along a line, both ends included, each once with those that are there already.
void add_line(Cells& cells, Eigen::Vector2d from, Eigen::Vector2d to) {
  std::set<std::pair<int, int>> there;
  for (const auto& c : cells) there.emplace(c.x(), c.y());
  for (double t = 0; t <= 1; t += 0.002) {
    const Eigen::Vector2d at = from + t * (to - from);
    const std::pair cell(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())));
    if (there.insert(cell).second) cells.emplace_back(cell.first, cell.second);
  }
}

/// A car of 36 x 15 cells (4.3 x 1.8 m) with a corner at (20, 20), of which one end and one side were seen.
Cells seen_from_behind(double yaw) {
  const Eigen::Vector2d corner(20, 20), along(std::cos(yaw), std::sin(yaw)), across(-along.y(), along.x());
  Cells cells;
  add_line(cells, corner, corner + 36 * along);
  add_line(cells, corner, corner + 15 * across);
  return cells;
}

TEST(VehicleOutline, TwoSidesTellOfTheWholeRectangle) {
  for (const double yaw : {0.0, 0.2, 0.7, 1.3}) {
    const auto outline = VehicleOutline::of(seen_from_behind(yaw));
    ASSERT_TRUE(outline);
    const Eigen::Vector2d along(std::cos(yaw), std::sin(yaw)), across(-along.y(), along.x());
    const auto contains = [&](double u, double v) {
      const Eigen::Vector2d at = Eigen::Vector2d(20, 20) + u * along + v * across;
      return outline->contains({static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y()))});
    };
    EXPECT_TRUE(contains(18, 7)) << yaw;
    EXPECT_TRUE(contains(34, 13)) << yaw << ": the corner that nobody saw";
    EXPECT_FALSE(contains(39, 7)) << yaw;
    EXPECT_FALSE(contains(18, 18)) << yaw;
    EXPECT_FALSE(contains(-3, 7)) << yaw;
    EXPECT_FALSE(contains(18, -3)) << yaw;
  }
}

TEST(VehicleOutline, WindowsMayLeanInwards) {
  Cells cells;
  add_line(cells, {20, 20}, {35, 20});
  add_line(cells, {35, 20}, {35, 38});
  add_line(cells, {34, 38}, {32, 39});
  add_line(cells, {32, 39}, {32, 54});
  const auto outline = VehicleOutline::of(cells);
  ASSERT_TRUE(outline);
  EXPECT_TRUE(outline->contains({22, 50}));
}

TEST(VehicleOutline, OneSideAloneTellsOfNoMore) {
  Cells cells;
  add_line(cells, {20, 20}, {50, 20});
  const auto outline = VehicleOutline::of(cells);
  ASSERT_TRUE(outline);
  EXPECT_TRUE(outline->contains({35, 20}));
  EXPECT_FALSE(outline->contains({35, 22}));
}

TEST(VehicleOutline, WhatHasNoCornerIsItsHull) {
  Cells cells;  // parked askew between two posts, say: a slope, not a corner
  add_line(cells, {20, 20}, {32, 26});
  add_line(cells, {32, 26}, {44, 40});
  const auto outline = VehicleOutline::of(cells);
  ASSERT_TRUE(outline);
  EXPECT_TRUE(outline->contains({32, 30}));
  EXPECT_FALSE(outline->contains({24, 36}));
  EXPECT_FALSE(outline->contains({42, 24}));
}

TEST(VehicleOutline, APostAndAHouseAreNoVehicle) {
  Cells post, house;
  add_line(post, {20, 20}, {24, 20});
  add_line(house, {0, 0}, {70, 0});
  add_line(house, {0, 0}, {0, 60});
  EXPECT_FALSE(VehicleOutline::of(post));
  EXPECT_FALSE(VehicleOutline::of(house));
  EXPECT_FALSE(VehicleOutline::of({}));
}

}  // namespace
}  // namespace curbstone::semantic_map::cells
