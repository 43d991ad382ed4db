#include "services/mapper/voxels/flat_index.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace curbstone::mapper::voxels {
namespace {

TEST(FlatIndex, KnowsWhatAMapKnowsThroughInsertingAndErasing) {
  std::mt19937 random(5);
  std::uniform_int_distribution<VoxelKey> keys(0, 700);
  FlatIndex index(4);
  std::map<VoxelKey, std::uint32_t> known;
  for (std::uint32_t i = 0; i < 20'000; ++i) {
    const VoxelKey key = keys(random) << 21;
    if (random() % 2 == 0) {
      const auto [it, added] = known.try_emplace(key, i);
      EXPECT_EQ(index.find_or_insert(key, i), added ? FlatIndex::kNone : it->second);
    } else {
      index.erase(key);
      known.erase(key);
    }
    ASSERT_EQ(index.size(), known.size());
  }
  for (VoxelKey key = 0; key <= 700; ++key) {
    const auto it = known.find(key << 21);
    EXPECT_EQ(index.find(key << 21), it == known.end() ? FlatIndex::kNone : it->second);
  }
}

TEST(FlatIndex, RoundsDown) {
  EXPECT_EQ(floor_to_int(1.9), 1);
  EXPECT_EQ(floor_to_int(-1.9), -2);
  EXPECT_EQ(floor_to_int(-2.0), -2);
  EXPECT_EQ(floor_to_int(-0.0), 0);
  EXPECT_EQ(floor_to_int(-1e-12), -1);
}

}  // namespace
}  // namespace curbstone::mapper::voxels
