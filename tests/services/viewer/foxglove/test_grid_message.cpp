#include "services/viewer/foxglove/grid_message.hpp"

#include <foxglove/packed.pb.h>
#include <gmock/gmock.h>

#include <cmath>
#include <cstring>

#include "tests/services/viewer/tiles.hpp"

namespace curbstone::viewer::foxglove {
namespace {

/// A tile of road at 1 m, without heights where `bare`.
store::TileCells road(std::int32_t revision = 1) {
  store::TileCells cells{.utime = 5, .revision = revision, .z_origin = 0};
  cells.cell_class.fill(semantic_tile_t::ROAD);
  cells.height.fill(500);
  cells.cost.fill(7);
  cells.confidence.fill(200);
  return cells;
}

class Grid {
 public:
  explicit Grid(const std::string& bytes) { EXPECT_TRUE(grid.ParseFromString(bytes)); }
  /// By the names of the message's own fields.
  [[nodiscard]] double at(std::size_t column, std::size_t row, const std::string& name) const {
    const std::size_t cell = row * grid.row_stride() + column * grid.cell_stride();
    for (const auto& field : grid.fields()) {
      if (field.name() != name) continue;
      if (field.type() == ::foxglove::PackedElementField::UINT8)
        return static_cast<std::uint8_t>(grid.data()[cell + field.offset()]);
      float value = 0;
      std::memcpy(&value, &grid.data()[cell + field.offset()], sizeof value);
      return double{value};
    }
    return -1;
  }
  [[nodiscard]] std::size_t rows() const { return grid.data().size() / grid.row_stride(); }
  ::foxglove::Grid grid;
};

TEST(GridMessageTest, OfTheWindowHasTheCellsWhereTheyLieInMap) {
  store::LiveMap map;
  store::TileCells cells = road();
  cells.cell_class[3 + 25 * 2] = semantic_tile_t::CURB;
  cells.height[3 + 25 * 2] = 560;
  cells.cell_class[0] = semantic_tile_t::UNKNOWN;
  cells.height[0] = semantic_tile_t::NO_HEIGHT;
  map.put({-4, 7}, cells);
  const Grid grid(window_grid(map, {-3, 9}, 1'700'000'000'123'456));
  EXPECT_EQ(grid.grid.frame_id(), "map");
  EXPECT_EQ(grid.grid.timestamp().seconds(), 1'700'000'000);
  EXPECT_EQ(grid.grid.timestamp().nanos(), 123'456'000);
  EXPECT_EQ(grid.grid.column_count(), 500U);
  EXPECT_EQ(grid.rows(), 500U);
  EXPECT_DOUBLE_EQ(grid.grid.cell_size().x(), 0.12);
  EXPECT_DOUBLE_EQ(grid.grid.pose().position().x(), -39);  // tile -3 - 10
  EXPECT_DOUBLE_EQ(grid.grid.pose().position().y(), -3);
  EXPECT_NEAR(grid.grid.pose().position().z(), 1.0, 1e-6) << "it lies at the road's height";
  EXPECT_EQ(grid.grid.pose().orientation().w(), 1);
  const std::size_t column = 9 * 25;
  const std::size_t row = 8 * 25;
  EXPECT_EQ(grid.at(column + 3, row + 2, "class"), 2);
  EXPECT_EQ(grid.at(column + 3, row + 2, "green"), 200);
  EXPECT_EQ(grid.at(column + 3, row + 2, "alpha"), 255);
  EXPECT_NEAR(grid.at(column + 3, row + 2, "elevation"), 1.12, 1e-6);
  EXPECT_EQ(grid.at(column + 4, row + 2, "class"), 1);
  EXPECT_EQ(grid.at(column + 4, row + 2, "cost"), 7);
  EXPECT_EQ(grid.at(column + 4, row + 2, "confidence"), 200);
  EXPECT_EQ(grid.at(column, row, "alpha"), 0);
  EXPECT_TRUE(std::isnan(grid.at(column, row, "elevation")));
  EXPECT_EQ(grid.at(0, 0, "alpha"), 0) << "where no tile is";
  EXPECT_EQ(grid.at(0, 0, "cost"), 255);
}

TEST(GridMessageTest, OfTheWindowLeavesOutWhatIsFarAway) {
  store::LiveMap map;
  map.put({10, 0}, road());
  map.put({9, 9}, road());
  map.put({-11, 0}, road());
  const Grid grid(window_grid(map, {0, 0}, 1));
  std::size_t roads = 0;
  for (std::size_t row = 0; row < 500; ++row)
    for (std::size_t column = 0; column < 500; ++column) roads += grid.at(column, row, "class") == 1 ? 1U : 0U;
  EXPECT_EQ(roads, 625U);
  EXPECT_EQ(grid.at(499, 499, "class"), 1);
}

TEST(GridMessageTest, OfTheWholeMapReachesFromEdgeToEdge) {
  store::LiveMap map;
  map.put({-2, 0}, road());
  map.put({3, 1}, road());
  const Grid grid(whole_grid(map, 1));
  EXPECT_EQ(grid.grid.column_count(), 150U);
  EXPECT_EQ(grid.rows(), 50U);
  EXPECT_DOUBLE_EQ(grid.grid.pose().position().x(), -6);
  EXPECT_EQ(grid.at(0, 0, "class"), 1);
  EXPECT_EQ(grid.at(149, 49, "class"), 1);
  EXPECT_EQ(grid.at(149, 0, "alpha"), 0);
}

TEST(GridMessageTest, OfAMapThatIsTooLargeHasLargerCellsThatKeepTheCurbs) {
  store::LiveMap map;
  store::TileCells cells = road();
  cells.cell_class[0] = semantic_tile_t::CURB;  // one of those that are put together
  map.put({0, 0}, cells);
  map.put({99, 99}, road());  // 2500 x 2500 cells
  const Grid grid(whole_grid(map, 1));
  EXPECT_LE(grid.grid.column_count() * grid.rows(), static_cast<std::size_t>(kMaxWholeCells));
  EXPECT_EQ(grid.grid.column_count(), 1250U);
  EXPECT_DOUBLE_EQ(grid.grid.cell_size().x(), 0.24);
  EXPECT_EQ(grid.at(0, 0, "class"), 2);
  EXPECT_EQ(grid.at(1, 0, "class"), 1);
}

TEST(GridMessageTest, OfTilesAtTheEndsOfTheWorldIsNoMessage) {
  store::LiveMap map;
  EXPECT_EQ(whole_grid(map, 1), "");
  map.put({INT32_MIN, 0}, road());
  map.put({INT32_MAX, 0}, road());
  EXPECT_EQ(whole_grid(map, 1), "");
  EXPECT_FALSE(window_grid(map, {0, 0}, 1).empty());
}

}  // namespace
}  // namespace curbstone::viewer::foxglove
