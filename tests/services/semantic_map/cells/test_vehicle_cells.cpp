#include "services/semantic_map/cells/vehicle_cells.hpp"

#include <gtest/gtest.h>

#include <bitset>
#include <cstddef>
#include <memory>

namespace curbstone::semantic_map::cells {
namespace {

using TileCells = std::bitset<tile::kCellsInTile>;

TileCells cell_rectangle(int column0, int row0, int columns, int rows) {
  TileCells cells;
  for (int row = row0; row < row0 + rows; ++row) {
    for (int column = column0; column < column0 + columns; ++column)
      cells.set(static_cast<std::size_t>(row * kCellsPerTile + column));
  }
  return cells;
}

/// A tile where only these cells are blocked, all as high as a vehicle.
std::unique_ptr<CellColumns> standing_in(const TileCells& cells) {
  auto columns = std::make_unique<CellColumns>();
  columns->standing = columns->blocked = columns->high = cells;
  return columns;
}

/// Asks one memo again and again: it must say what find_vehicles() says.
class VehicleCellsTest : public ::testing::Test {
 protected:
  TileCells beneath(const CellColumns& columns, const CellColumns* east = nullptr) {
    tile::Around<CellColumns> around;
    around.set(0, 0, &columns);
    around.set(1, 0, east);
    const TileCells found = find_vehicles(around).beneath;
    EXPECT_EQ(memo_.find({}, around).beneath, found);
    return found;
  }

 private:
  VehicleCache memo_;
};

TEST_F(VehicleCellsTest, AreThoseOfWhatStandsNowWhateverWasAskedBefore) {
  for (int again = 0; again < 2; ++again) {
    for (int columns = 16; columns < 22; ++columns) {
      for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 14; ++row) {
          const TileCells car = cell_rectangle(column, row, columns, 11);
          ASSERT_EQ(beneath(*standing_in(car)), car) << columns << ' ' << column << ' ' << row;
        }
      }
    }
  }
}

TEST_F(VehicleCellsTest, AreAskedForAnewWhenSomethingComesToStandBeside) {
  const auto here = standing_in(cell_rectangle(15, 5, 10, 11));
  const auto rest = standing_in(cell_rectangle(0, 5, 10, 11));
  const auto wall = standing_in(cell_rectangle(0, 0, 25, 25));
  EXPECT_EQ(beneath(*here, rest.get()), here->blocked);
  EXPECT_TRUE(beneath(*here, wall.get()).none()) << "together too large for a vehicle";
  EXPECT_EQ(beneath(*here, rest.get()), here->blocked);
}

TEST_F(VehicleCellsTest, AreAskedForAnewWhenWhatStandsTurnsOutHigh) {
  const auto low = standing_in(cell_rectangle(2, 5, 20, 11));
  low->high.reset();
  for (std::size_t i = 0; i < 10; ++i) low->high.set(static_cast<std::size_t>(5 * kCellsPerTile + 2) + i);
  EXPECT_EQ(beneath(*low), low->blocked);
  low->high.reset(static_cast<std::size_t>(5 * kCellsPerTile + 2));
  EXPECT_TRUE(beneath(*low).none()) << "nine high cells are a post's";
}

}  // namespace
}  // namespace curbstone::semantic_map::cells
