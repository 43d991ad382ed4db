#include <gtest/gtest.h>

#include "services/viewer/store/live_map.hpp"
#include "tests/services/viewer/tiles.hpp"

namespace curbstone::viewer::store {
namespace {

using TilePut = LiveMap::Put;

TEST(LiveMapTest, NumbersEachChangeAndKeepsTheLastNumberOfATile) {
  std::mt19937 random(1);
  LiveMap map;
  EXPECT_EQ(map.put({1, 2}, draw_cells(random, 1)), TilePut::kTaken);
  EXPECT_EQ(map.put({3, 4}, draw_cells(random, 1)), TilePut::kTaken);
  const TileCells last = draw_cells(random, 2);
  EXPECT_EQ(map.put({1, 2}, last), TilePut::kTaken);
  EXPECT_EQ(map.number(), 3U);
  const auto changes = map.above(0, 10);
  ASSERT_EQ(changes.size(), 2U);
  EXPECT_EQ(changes[0].key, (TileKey{3, 4}));
  EXPECT_EQ(changes[1].number, 3U);
  EXPECT_EQ(*changes[1].cells, last);
  EXPECT_EQ(map.above(2, 10).size(), 1U);
  EXPECT_EQ(map.above(3, 10).size(), 0U);
  EXPECT_EQ(map.above(0, 1).size(), 1U);
}

TEST(LiveMapTest, LeavesATileThatIsNotNewer) {
  std::mt19937 random(1);
  LiveMap map;
  const TileCells tile = draw_cells(random, 5);
  map.put({0, 0}, tile);
  EXPECT_EQ(map.put({0, 0}, draw_cells(random, 5)), TilePut::kKnown);
  EXPECT_EQ(map.put({0, 0}, draw_cells(random, 4)), TilePut::kKnown);
  EXPECT_EQ(*map.at({0, 0}), tile);
  EXPECT_EQ(map.number(), 1U);
}

TEST(LiveMapTest, GoesOnCountingWhenItWasCleared) {
  std::mt19937 random(1);
  LiveMap map;
  map.put({0, 0}, draw_cells(random, 5));
  map.clear();
  EXPECT_EQ(map.size(), 0U);
  EXPECT_EQ(map.at({0, 0}), nullptr);
  EXPECT_TRUE(map.above(0, 10).empty());
  map.put({0, 0}, draw_cells(random, 1));
  EXPECT_EQ(map.number(), 2U);
}

TEST(TileCellsTest, RefuseWhatIsOutOfRange) {
  semantic_tile_t message{};
  message.utime = message.curbs_utime = 1;
  ASSERT_TRUE(cells_of(message).has_value());
  const auto refused = [&](auto spoil) {
    semantic_tile_t bad = message;
    spoil(bad);
    return !cells_of(bad).has_value();
  };
  EXPECT_TRUE(refused([](semantic_tile_t& m) { m.cell_class[624] = 5; }));
  EXPECT_TRUE(refused([](semantic_tile_t& m) { m.z_origin = NAN; }));
  EXPECT_TRUE(refused([](semantic_tile_t& m) { m.utime = -1; }));
  EXPECT_TRUE(refused([](semantic_tile_t& m) { m.curbs_utime = INT64_MAX; }));
  EXPECT_TRUE(refused([](semantic_tile_t& m) { m.revision = -1; }));
  EXPECT_TRUE(refused([](semantic_tile_t& m) { m.tile_x = INT32_MAX; }));
  EXPECT_TRUE(refused([](semantic_tile_t& m) { m.tile_y = INT32_MIN; }));
}

}  // namespace
}  // namespace curbstone::viewer::store
