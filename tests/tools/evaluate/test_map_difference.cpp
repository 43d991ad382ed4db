#include "tools/evaluate/map_difference.hpp"

#include <gtest/gtest.h>

namespace curbstone::evaluate {
namespace {

StoredMap a_map() {
  StoredMap map;
  for (int x = 0; x < 3; ++x) {
    semantic_map::tile::MapTile tile;
    tile.key = {x, 0};
    tile.cell_class.fill(semantic_map::tile::CellClass::kRoad);
    map.tiles.push_back(tile);
    map.trajectory.push_back({1000 * (x + 1), x, Pose::Identity()});
  }
  map.curbs.push_back({7, 0.5F, false, {}});
  return map;
}

TEST(MapDifference, OfAMapAndItselfIsNone) {
  const MapDifference d = difference(a_map(), a_map());
  EXPECT_TRUE(d.none());
  EXPECT_EQ(d.tiles, 3);
  EXPECT_EQ(d.poses, 3);
}

TEST(MapDifference, CountsTilesCellsPosesAndCurbs) {
  StoredMap other = a_map();
  other.tiles[0].cell_class[5] = semantic_map::tile::CellClass::kCurb;
  other.tiles[1].utime = 9;
  other.tiles[2].key = {8, 8};  // one missing, one more
  other.trajectory[1].T_map_base.translation().x() = 0.25;
  other.trajectory.pop_back();
  other.curbs.clear();
  const MapDifference d = difference(a_map(), other);
  EXPECT_EQ(d.tiles, 4);
  EXPECT_EQ(d.tiles_differ, 4);
  EXPECT_EQ(d.classes_differ, 1 + 2 * semantic_map::tile::kCellsInTile);
  EXPECT_EQ(d.poses_differ, 2);
  EXPECT_DOUBLE_EQ(d.largest_m, 0.25);
  EXPECT_TRUE(d.curbs_differ);
  EXPECT_FALSE(d.none());
}

}  // namespace
}  // namespace curbstone::evaluate
