#include "services/semantic_map/cells/ground_gaps.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "services/semantic_map/cells/cell_classes.hpp"

namespace curbstone::semantic_map::cells {
namespace {

constexpr CellColumn seen_at(float z) {
  return {.points = 3, .ground_points = 3, .ground_z = z};
}

/// A tile and the one to its east, without any point.
class GroundGaps : public ::testing::Test {
 protected:
  /// A scan line along y, at a column of the tile; from 25 on, of its neighbour.
  void see_column(int column, float z) {
    CellColumns& columns = column < kCellsPerTile ? *here_ : *east_;
    for (int row = 0; row < kCellsPerTile; ++row) cell(columns, column % kCellsPerTile, row) = seen_at(z);
  }
  void put(int column, int row, const CellColumn& what) {
    cell(*here_, column, row) = what;
    if (what.blocking_points > 0) here_->standing.set(static_cast<std::size_t>(row * kCellsPerTile + column));
  }
  tile::MapTile classified() {
    tile::Around<CellColumns> around;
    around.set(0, 0, here_.get());
    around.set(1, 0, east_.get());
    tile::MapTile tile;
    classify_cells(around, {}, vehicles_, {}, tile);
    return tile;
  }
  static std::size_t index(int column, int row) { return static_cast<std::size_t>(row * kCellsPerTile + column); }
  VehicleCells vehicles_;

 private:
  static CellColumn& cell(CellColumns& columns, int column, int row) { return columns.cells[index(column, row)]; }
  std::unique_ptr<CellColumns> here_ = std::make_unique<CellColumns>();
  std::unique_ptr<CellColumns> east_ = std::make_unique<CellColumns>();
};

TEST_F(GroundGaps, CellsBetweenTwoScanLinesAreRoadAtAHeightBetweenTheirs) {
  see_column(5, 0.10F);
  see_column(10, 0.15F);
  const tile::MapTile tile = classified();
  for (int column = 6; column < 10; ++column) {
    const std::size_t i = index(column, 12);
    EXPECT_EQ(tile.cell_class[i], tile::CellClass::kRoad) << column;
    EXPECT_TRUE(tile.is_interpolated(i)) << column;
    EXPECT_NEAR(tile.height[i] * kPositionStep, 0.10 + 0.01 * (column - 5), 0.001) << column;
    EXPECT_EQ(tile.cost[i], 0) << column;
    EXPECT_EQ(tile.hits[i], 0) << column;
  }
  EXPECT_FALSE(tile.is_interpolated(index(5, 12))) << "seen";
  EXPECT_EQ(tile.cell_class[index(4, 12)], tile::CellClass::kUnknown) << "ground on one side only";
}

TEST_F(GroundGaps, AWiderGapStaysUnknown) {
  see_column(5, 0);
  see_column(11, 0);
  const tile::MapTile tile = classified();
  for (int column = 6; column < 11; ++column)
    EXPECT_EQ(tile.cell_class[index(column, 12)], tile::CellClass::kUnknown) << column;
}

TEST_F(GroundGaps, AGapBetweenTwoHeightsMayHideAKerbAndStaysUnknown) {
  see_column(5, 0);
  see_column(8, 0.10F);
  EXPECT_EQ(classified().cell_class[index(6, 12)], tile::CellClass::kUnknown);
}

TEST_F(GroundGaps, ASlopeIsNoStep) {
  see_column(5, 0);
  see_column(10, 0.09F);  // 15 %
  EXPECT_EQ(classified().cell_class[index(7, 12)], tile::CellClass::kRoad);
}

TEST_F(GroundGaps, NothingIsInterpolatedAcrossWhatStandsOrBelowTheGround) {
  see_column(5, 0);
  see_column(9, 0);
  put(6, 12, {.points = 1, .blocking_points = 1});
  put(6, 20, {.points = 1, .drop_points = 1});
  const tile::MapTile tile = classified();
  EXPECT_EQ(tile.cell_class[index(7, 12)], tile::CellClass::kUnknown);
  EXPECT_EQ(tile.cell_class[index(7, 20)], tile::CellClass::kUnknown);
  EXPECT_EQ(tile.cell_class[index(7, 16)], tile::CellClass::kRoad);
}

TEST_F(GroundGaps, TheEdgeOfAWallMayReachIntoTheCellsBesideItWhichStayUnknown) {
  see_column(5, 0);
  see_column(8, 0);
  put(7, 13, {.points = 9, .blocking_points = 9, .top = 1});
  const tile::MapTile tile = classified();
  EXPECT_EQ(tile.cell_class[index(6, 12)], tile::CellClass::kUnknown);
  EXPECT_EQ(tile.cell_class[index(6, 11)], tile::CellClass::kRoad);
}

TEST_F(GroundGaps, BranchesAboveTheVehicleDoNotMatter) {
  see_column(5, 0);
  see_column(8, 0);
  for (int row = 0; row < kCellsPerTile; ++row) put(6, row, {.points = 4, .ground_z = 3});
  const tile::MapTile tile = classified();
  EXPECT_EQ(tile.cell_class[index(6, 12)], tile::CellClass::kRoad);
  EXPECT_EQ(tile.height[index(6, 12)], 0);
}

TEST_F(GroundGaps, TheGroundBeneathAVehicleStaysAsItIs) {
  see_column(5, 0);
  see_column(8, 0);
  vehicles_.beneath.set(index(6, 12));
  EXPECT_EQ(classified().cell_class[index(6, 12)], tile::CellClass::kUnknown);
}

TEST_F(GroundGaps, AGapEndsInTheNextTileAsWell) {
  see_column(23, 0);
  see_column(27, 0);
  const tile::MapTile tile = classified();
  EXPECT_EQ(tile.cell_class[index(24, 0)], tile::CellClass::kRoad);
  EXPECT_EQ(tile.cell_class[index(24, 24)], tile::CellClass::kRoad);
}

}  // namespace
}  // namespace curbstone::semantic_map::cells
