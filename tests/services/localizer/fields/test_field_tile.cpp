#include "services/localizer/fields/field_tile.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace curbstone::localizer::fields {
namespace {

using semantic_map::tile::Around;
using semantic_map::tile::CellClass;
using semantic_map::tile::MapTile;

MapTile empty_tile() {
  MapTile tile;
  tile.height.fill(MapTile::kNoHeight);
  return tile;
}

void put_wall(MapTile& tile, std::size_t column, std::size_t row, std::uint8_t hits) {
  tile.cell_class[row * 25 + column] = CellClass::kWall;
  tile.hits[row * 25 + column] = hits;
}

void put_road(MapTile& tile, std::size_t cell, double steps) {
  tile.cell_class[cell] = CellClass::kRoad;
  tile.height[cell] = static_cast<std::int16_t>(std::lround(steps));
  tile.confidence[cell] = 32;
}

FieldTile field_of(const MapTile& tile) {
  Around<MapTile> around;
  around.set(0, 0, &tile);
  return make_field_tile(around);
}

TEST(FieldTile, FindsWhereAWallIsBetweenTwoRowsOfCellsByHowOftenEachWasHit) {
  MapTile tile = empty_tile();
  for (std::size_t column = 0; column < 25; ++column) {
    put_wall(tile, column, 10, 12);
    put_wall(tile, column, 11, 4);
  }
  const FieldTile field = field_of(tile);
  const auto nearest = field.nearest[13 * 25 + 12];
  ASSERT_NE(nearest, 0);
  const Upright& wall = field.uprights[nearest - 1U];
  ASSERT_TRUE(wall.is_line());
  EXPECT_NEAR(std::abs(wall.normal.y()), 1, 1e-3);
  EXPECT_NEAR(wall.centre.y(), 0.12 * (10.5 + 0.25), 1e-4);
}

TEST(FieldTile, GivesAPoleNoDirection) {
  MapTile tile = empty_tile();
  put_wall(tile, 5, 5, 9);
  const FieldTile field = field_of(tile);
  ASSERT_EQ(field.uprights.size(), 1U);
  EXPECT_FALSE(field.uprights[0].is_line());
  EXPECT_EQ(field.nearest[5 * 25 + 10], 1) << "five cells away";
  EXPECT_EQ(field.nearest[5 * 25 + 11], 0) << "six cells away";
}

TEST(FieldTile, LeavesOutTheInsideOfAVehiclesOutlineWhichNobodySaw) {
  MapTile tile = empty_tile();
  put_wall(tile, 5, 5, 0);
  EXPECT_TRUE(field_of(tile).uprights.empty());
}

TEST(FieldTile, TakesHeightsFromTheGroundAloneAndOneCellOfEachNeighbour) {
  MapTile tile = empty_tile(), east = empty_tile();
  tile.z_origin = 2;
  put_road(tile, 0, 50);
  put_wall(tile, 1, 0, 9);
  tile.height[1] = 700;
  put_road(east, 0, -50);
  Around<MapTile> around;
  around.set(0, 0, &tile);
  around.set(1, 0, &east);
  const FieldTile field = make_field_tile(around);
  EXPECT_NEAR(field.height_of(0, 0), 2.1, 1e-6);
  EXPECT_TRUE(std::isnan(field.height_of(1, 0))) << "under a wall";
  EXPECT_NEAR(field.height_of(25, 0), -0.1, 1e-6);
}

TEST(FieldTile, AnInterpolatedHeightIsNoMeasurement) {
  MapTile tile = empty_tile();
  put_road(tile, 0, 50);
  tile.confidence[0] = 0;
  EXPECT_TRUE(std::isnan(field_of(tile).height_of(0, 0)));
}

/// Ground that is 0.1 m higher beyond a line through the tile's middle, with noise of 1 cm.
MapTile curb_along(double direction) {
  MapTile tile = empty_tile();
  std::mt19937 random(2);
  std::normal_distribution<double> noise(0, 5);  // steps
  for (int i = 0; i < semantic_map::tile::kCellsInTile; ++i) {
    const double x = i % 25 - 12.0, y = i / 25 - 12.0;
    const bool is_high = std::cos(direction) * y - std::sin(direction) * x > 0;
    put_road(tile, static_cast<std::size_t>(i), (is_high ? 50 : 0) + noise(random));
  }
  return tile;
}

TEST(FieldTile, TellsInWhichDirectionACurbRisesMoreExactlyThanOneCellCould) {
  double squares = 0;
  int num = 0;
  for (double direction = -1.5; direction < 1.6; direction += 0.1, ++num) {
    const FieldTile field = field_of(curb_along(direction));
    const Eigen::Vector2d& rise = rise_of(field.rise[12 * 25 + 12]);
    EXPECT_NEAR(rise.norm(), 1, 1e-9);
    squares += std::pow(rise.dot(Eigen::Vector2d(std::cos(direction), std::sin(direction))), 2);
  }
  EXPECT_LT(std::sqrt(squares / num), 0.15);
}

TEST(FieldTile, LevelGroundHasNoEdges) {
  MapTile tile = empty_tile();
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 5);
  for (std::size_t i = 0; i < semantic_map::tile::kCellsInTile; ++i) put_road(tile, i, noise(random));
  const FieldTile field = field_of(tile);
  EXPECT_EQ(std::count(field.rise.begin(), field.rise.end(), 0), semantic_map::tile::kCellsInTile);
  EXPECT_TRUE(rise_of(0).isZero());
}

}  // namespace
}  // namespace curbstone::localizer::fields
