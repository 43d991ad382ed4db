#include "services/semantic_map/tile/voted_tile_packing.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>

namespace curbstone::semantic_map::tile {
namespace {

/// As it comes from a worker: positions in whole steps, of every four points the first one votes.
VotedTile street_tile() {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> step(0, kStepsPerTile - 1);
  std::normal_distribution<float> noise(0, 0.02F);
  VotedTile tile{
      .key = {-3, 70}, .utime = 1234567, .revision = 98, .z_origin = -12, .points = {}, .intensity = {}, .chain = -77};
  for (std::uint32_t i = 0; i < 4000; ++i) {
    VotedPoint p;
    const bool votes = i % 4 == 0;
    if (votes) {
      p.normal = Eigen::Vector3f(noise(random), noise(random), 1).normalized();
      p.stick = 0.5F + noise(random);
      p.plate = 0.1F;
      p.mass = 30 + 100 * noise(random);
    }
    p.x = static_cast<float>(step(random)) * static_cast<float>(kPositionStep);
    p.y = static_cast<float>(step(random)) * static_cast<float>(kPositionStep);
    p.z = tile.z_origin + std::round(50 * noise(random)) * static_cast<float>(kPositionStep);
    if (votes) {
      tile.points.push_back(p);
    } else {
      tile.points.append(VotedPoints::Place{p.x, p.y, p.z, i / 4});
    }
    tile.intensity.push_back(static_cast<std::uint8_t>(60 + i % 9));
  }
  return tile;
}

PackedValues packed(const VotedTile& tile) {
  ValuePacker packer;
  pack(tile, packer);
  return packer.pack();
}

void expect_every_bit_back(const VotedTile& tile) {
  const PackedValues bytes = packed(tile);
  ValueUnpacker unpacker(bytes);
  const VotedTile again = unpack_voted_tile(unpacker);
  EXPECT_EQ(again.key, tile.key);
  EXPECT_EQ(again.utime, tile.utime);
  EXPECT_EQ(again.revision, tile.revision);
  EXPECT_EQ(again.z_origin, tile.z_origin);
  EXPECT_EQ(again.chain, tile.chain);
  EXPECT_EQ(again.intensity, tile.intensity);
  ASSERT_EQ(again.points.size(), tile.points.size());
  EXPECT_EQ(again.points.tensors().size(), tile.points.tensors().size());
  for (std::size_t i = 0; i < tile.points.size(); ++i) {
    const auto values = [](const VotedPoint& p) {
      return std::array{p.x, p.y, p.z, p.normal.x(), p.normal.y(), p.normal.z(), p.stick, p.plate, p.mass};
    };
    const auto a = values(again.points[i]);
    const auto b = values(tile.points[i]);
    ASSERT_EQ(std::memcmp(a.data(), b.data(), sizeof(a)), 0) << i;
  }
}

TEST(VotedTilePacking, BringsBackEveryBitFromAFourthOfTheRoom) {
  const VotedTile tile = street_tile();
  expect_every_bit_back(tile);
  EXPECT_LT(packed(tile).size(), tile.points.size() * sizeof(VotedPoint) / 4);
}

TEST(VotedTilePacking, BringsBackPointsThatLieOnNoSteps) {
  VotedTile tile = street_tile();
  tile.points.append(VotedPoints::Place{1.0001F, 1, tile.z_origin, 7});
  tile.points.append(VotedPoints::Place{1, -0.0F, std::nanf("1"), 0});
  tile.points.push_back(VotedPoint{{}, 1, 1, 1e30F});
  expect_every_bit_back(tile);
}

TEST(VotedTilePacking, BringsBackTensorsThatAreNoNumbers) {
  VotedTile tile = street_tile();
  VotedTensor odd = tile.points[6];
  odd.mass = std::nanf("5");
  tile.points.set_tensor(tile.points.places()[6].tensor, odd);
  expect_every_bit_back(tile);
}

TEST(VotedTilePacking, BringsBackATileWithoutIntensitiesAndAnEmptyOne) {
  VotedTile tile = street_tile();
  tile.intensity.clear();
  expect_every_bit_back(tile);
  expect_every_bit_back({});
}

}  // namespace
}  // namespace curbstone::semantic_map::tile
