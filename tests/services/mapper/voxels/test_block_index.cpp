#include "services/mapper/voxels/block_index.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>
#include <tuple>

namespace curbstone::mapper::voxels {
namespace {

using Cell = std::tuple<int, int, int>;

/// Cells about the origin, on both sides of it, each with a place of its own.
struct ScatteredCells {
  BlockIndex index;
  std::map<Cell, std::uint32_t> known;

  ScatteredCells() {
    std::mt19937 random(1);
    std::uniform_int_distribution<int> coordinate(-9, 9);
    for (std::uint32_t i = 0; i < 1500; ++i) {
      const Eigen::Vector3i cell(coordinate(random), coordinate(random), coordinate(random));
      std::uint32_t& place = index.place(cell);
      if (place == BlockIndex::kNone) place = i;
      known.try_emplace({cell.x(), cell.y(), cell.z()}, i);
    }
  }
  [[nodiscard]] std::uint32_t expected(int x, int y, int z) const {
    const auto it = known.find({x, y, z});
    return it == known.end() ? BlockIndex::kNone : it->second;
  }
};

TEST(BlockIndex, FindsWhatAMapFinds) {
  const ScatteredCells cells;
  for (int x = -14; x <= 14; ++x) {
    for (int y = -14; y <= 14; ++y) {
      for (int z = -14; z <= 14; ++z) EXPECT_EQ(cells.index.find({x, y, z}), cells.expected(x, y, z));
    }
  }
}

TEST(BlockIndex, VisitsTheNeighboursInOrder) {
  const ScatteredCells cells;
  for (int x = -10; x <= 10; ++x) {
    for (int y = -10; y <= 10; ++y) {
      for (int z = -10; z <= 10; ++z) {
        std::vector<std::uint32_t> expected, visited;
        for (int i = 0; i < 27; ++i) {
          const std::uint32_t place = cells.expected(x + i / 9 - 1, y + i / 3 % 3 - 1, z + i % 3 - 1);
          if (place != BlockIndex::kNone) expected.push_back(place);
        }
        cells.index.around({x, y, z}, [&](std::uint32_t place, int dx, int dy, int dz) {
          visited.push_back(place);
          EXPECT_EQ(place, cells.expected(x + dx, y + dy, z + dz));
        });
        ASSERT_EQ(visited, expected);
      }
    }
  }
}

TEST(BlockIndex, ForgetsBlocksAndSaysWhatWasInThem) {
  ScatteredCells cells;
  std::set<std::uint32_t> forgotten;
  cells.index.erase_blocks([](const Eigen::Vector3i& middle) { return middle.x() < 0; },
                           [&](std::uint32_t place) { forgotten.insert(place); });
  for (const auto& [cell, place] : cells.known) {
    const auto [x, y, z] = cell;
    EXPECT_EQ(cells.index.find({x, y, z}), x < 0 ? BlockIndex::kNone : place);
    EXPECT_EQ(forgotten.count(place), x < 0 ? 1U : 0U);
  }
  EXPECT_EQ(cells.index.place({-3, 0, 0}), BlockIndex::kNone);  // and can be had again
}

TEST(BlockIndex, FindsInStepsWhatItFindsAtOnce) {
  const ScatteredCells cells;
  for (int x = -12; x <= 12; ++x) {
    for (int y = -12; y <= 12; ++y) {
      for (int z = -12; z <= 12; ++z) {
        const Eigen::Vector3i cell(x, y, z);
        ASSERT_EQ(cells.index.find_in(cells.index.block(cell), cell), cells.expected(x, y, z));
      }
    }
  }
}

}  // namespace
}  // namespace curbstone::mapper::voxels
