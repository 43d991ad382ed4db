#include "services/semantic_map/cells/vehicle_cells.hpp"

#include <gtest/gtest.h>

#include <array>
#include <bitset>
#include <cstddef>
#include <memory>
#include <vector>

namespace curbstone::semantic_map::cells {
namespace {

constexpr int kTiles = 7;  // tiles of the world along each axis

/// Standing cells in a world of kTiles x kTiles tiles, all as high as a vehicle unless they are said to be low.
class StandingWorld {
 public:
  StandingWorld() : tiles_(static_cast<std::size_t>(kTiles * kTiles)) {}

  void stand(int column, int row, bool high = true) {
    CellColumns& tile = tiles_.at(tile_of(column, row));
    const std::size_t cell = cell_of(column, row);
    tile.standing.set(cell);
    tile.blocked.set(cell);
    tile.high.set(cell, high);
  }
  void stand_in(int column0, int row0, int columns, int rows) {
    for (int row = row0; row < row0 + rows; ++row) {
      for (int column = column0; column < column0 + columns; ++column) stand(column, row);
    }
  }

  /// Finds the vehicles of all tiles in which something stands (the others may not exist), then what they cover.
  void cover() {
    std::vector<std::vector<VehicleOutline>> vehicles(tiles_.size());
    for_each_tile([&](int x, int y) {
      if (tiles_[index(x, y)].blocked.any()) vehicles[index(x, y)] = find_vehicles(around(tiles_, x, y));
    });
    num_vehicles_ = 0;
    for (const auto& found : vehicles) num_vehicles_ += found.size();
    covered_.resize(tiles_.size());
    for_each_tile([&](int x, int y) { covered_[index(x, y)] = cover_vehicles(around(vehicles, x, y)); });
  }
  [[nodiscard]] std::size_t num_vehicles() const { return num_vehicles_; }
  [[nodiscard]] bool is_covered(int column, int row) const {
    return covered_.at(tile_of(column, row)).beneath[cell_of(column, row)];
  }
  [[nodiscard]] std::size_t num_covered() const {
    std::size_t num = 0;
    for (const VehicleCells& cells : covered_) num += cells.beneath.count();
    return num;
  }

 private:
  static std::size_t index(int x, int y) { return static_cast<std::size_t>(y * kTiles + x); }
  static std::size_t tile_of(int column, int row) { return index(column / kCellsPerTile, row / kCellsPerTile); }
  static std::size_t cell_of(int column, int row) {
    return static_cast<std::size_t>(row % kCellsPerTile * kCellsPerTile + column % kCellsPerTile);
  }
  template <class Visit>
  static void for_each_tile(Visit visit) {
    for (int y = 0; y < kTiles; ++y) {
      for (int x = 0; x < kTiles; ++x) visit(x, y);
    }
  }
  template <class T>
  static tile::Around<T> around(const std::vector<T>& all, int x, int y) {
    tile::Around<T> result;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        if (x + dx < 0 || x + dx >= kTiles || y + dy < 0 || y + dy >= kTiles) continue;
        result.set(dx, dy, &all[index(x + dx, y + dy)]);
      }
    }
    return result;
  }

  std::vector<CellColumns> tiles_;
  std::vector<VehicleCells> covered_;
  std::size_t num_vehicles_ = 0;
};

TEST(VehicleCells, OfAWholeCarAreTheCarWhereverItStands) {
  for (int column = 60; column < 60 + kCellsPerTile; column += 3) {
    for (int row = 70; row < 70 + kCellsPerTile; row += 4) {
      StandingWorld world;
      world.stand_in(column, row, 39, 15);
      world.cover();
      ASSERT_EQ(world.num_vehicles(), 1U) << column << ' ' << row;
      ASSERT_EQ(world.num_covered(), 39U * 15U) << column << ' ' << row;
    }
  }
}

TEST(VehicleCells, TwoSidesOfACarCoverItsFarCornerWhereverItStands) {
  constexpr int kLong = 40;  // 4.8 m
  constexpr int kWide = 15;
  for (int column = 60; column < 60 + kCellsPerTile; ++column) {
    for (int row = 60; row < 60 + kCellsPerTile; row += 3) {
      StandingWorld world;
      for (int i = 0; i < kLong; ++i) world.stand(column + i, row);
      for (int i = 0; i < kWide; ++i) world.stand(column, row + i);
      world.cover();
      ASSERT_EQ(world.num_vehicles(), 1U) << column << ' ' << row;
      EXPECT_TRUE(world.is_covered(column + kLong - 1, row + kWide - 1)) << column << ' ' << row;
      EXPECT_EQ(world.num_covered(), static_cast<std::size_t>(kLong * kWide)) << column << ' ' << row;
    }
  }
}

TEST(VehicleCells, AHouseCoversNothingWhereverItEnds) {
  for (int column = 40; column < 40 + kCellsPerTile; ++column) {
    StandingWorld world;
    world.stand_in(column, 60, 90, 30);
    world.cover();
    EXPECT_EQ(world.num_covered(), 0U) << column;
  }
}

TEST(VehicleCells, AWallIsTakenForNoMoreThanItself) {
  for (int column = 40; column < 40 + kCellsPerTile; ++column) {
    StandingWorld world;
    world.stand_in(column, 70, 100, 2);
    world.cover();
    for (const int row : {69, 72}) EXPECT_FALSE(world.is_covered(column, row) || world.is_covered(column + 50, row));
    EXPECT_LE(world.num_covered(), 200U) << column;
  }
}

TEST(VehicleCells, WithNineHighCellsThereIsNoVehicle) {
  for (const int num_high : {9, 10}) {
    StandingWorld world;
    for (int row = 70; row < 81; ++row) {
      for (int column = 60; column < 80; ++column) world.stand(column, row, row == 70 && column < 60 + num_high);
    }
    world.cover();
    EXPECT_EQ(world.num_covered(), num_high == 10 ? 20U * 11U : 0U);
  }
}

}  // namespace
}  // namespace curbstone::semantic_map::cells
