#include "services/tensor_voting/voting/voxel_table.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace curbstone::tensor_voting::voting {
namespace {

TEST(VoxelTable, NumbersVoxelsInTheOrderInWhichTheyCome) {
  std::mt19937 random(5);
  std::uniform_int_distribution<std::int64_t> place(-20, 20);
  VoxelTable table;
  std::map<std::uint64_t, std::uint32_t> expected;
  for (int i = 0; i < 100'000; ++i) {
    const std::uint64_t voxel = VoxelTable::key(place(random), place(random), place(random));
    const auto number = static_cast<std::uint32_t>(expected.size());
    ASSERT_EQ(table.find_or_insert(voxel), expected.try_emplace(voxel, number).first->second);
  }
  EXPECT_GT(expected.size(), 50'000U);
}

TEST(VoxelTable, TellsApartVoxelsAsFarAwayAsTheLatticeGoes) {
  VoxelTable table;
  EXPECT_EQ(table.find_or_insert(VoxelTable::key(0, 0, 0)), 0U);
  EXPECT_EQ(table.find_or_insert(VoxelTable::key(-1, 0, 0)), 1U);
  EXPECT_EQ(table.find_or_insert(VoxelTable::key(0, 1'000'000, 0)), 2U);
  EXPECT_EQ(table.find_or_insert(VoxelTable::key(0, 0, -1'000'000)), 3U);
  EXPECT_EQ(table.find_or_insert(VoxelTable::key(-1, 0, 0)), 1U);
}

}  // namespace
}  // namespace curbstone::tensor_voting::voting
