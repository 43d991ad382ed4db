#include "common/tiles/tile.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace curbstone {
namespace {

TEST(Tile, CellsAndStepsFillATile) {
  EXPECT_DOUBLE_EQ(kCellsPerTile * kCellSize, kTileSize);
  EXPECT_DOUBLE_EQ(kStepsPerTile * kPositionStep, kTileSize);
}

TEST(Tile, NegativeCoordinatesRoundDown) {
  EXPECT_EQ(tile_at(0.0, 2.999), (TileKey{0, 0}));
  EXPECT_EQ(tile_at(-0.001, 3.0), (TileKey{-1, 1}));
}

TEST(Tile, RefusesWhatHasNoTile) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(tile_at(nan, 0));
  EXPECT_FALSE(tile_at(0, std::numeric_limits<double>::infinity()));
  EXPECT_FALSE(tile_at(1e10, 0));
}

}  // namespace
}  // namespace curbstone
