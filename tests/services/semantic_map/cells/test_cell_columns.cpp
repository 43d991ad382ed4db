#include "services/semantic_map/cells/cell_columns.hpp"

#include <gtest/gtest.h>

namespace curbstone::semantic_map::cells {
namespace {

TEST(CellColumns, ACellCountsItsFirstPointsAndNoMore) {
  tile::VotedTile tile;
  tile::VotedPoint p;
  p.x = 1;
  p.y = 1;
  for (int i = 0; i < CellColumn::kMaxPoints; ++i) tile.points.push_back(p);
  p.z = 9;
  for (int i = 0; i < 10'000; ++i) tile.points.push_back(p);
  const tile::Around<ground::GroundModel> no_ground;
  const CellColumns columns = measure_columns(tile, ground::GroundSurface(no_ground), {});
  EXPECT_EQ(columns.at(8, 8).points, CellColumn::kMaxPoints);
  EXPECT_EQ(columns.at(8, 8).ground_z, 0);
  EXPECT_EQ(columns.at(9, 8).points, 0);
}

}  // namespace
}  // namespace curbstone::semantic_map::cells
