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
  VotedTile tile{.key = {-3, 70},
                 .utime = 1234567,
                 .revision = 98,
                 .z_origin = -12,
                 .points = {},
                 .voters = {},
                 .intensity = {},
                 .chain = -77};
  for (std::uint32_t i = 0; i < 4000; ++i) {
    VotedPoint p;
    const std::uint32_t voter = i - i % 4;
    if (voter < i) {
      p = tile.points[voter];
    } else {
      p.normal = Eigen::Vector3f(noise(random), noise(random), 1).normalized();
      p.stick = 0.5F + noise(random);
      p.plate = 0.1F;
      p.mass = 30 + 100 * noise(random);
    }
    p.x = static_cast<float>(step(random)) * static_cast<float>(kPositionStep);
    p.y = static_cast<float>(step(random)) * static_cast<float>(kPositionStep);
    p.z = tile.z_origin + std::round(50 * noise(random)) * static_cast<float>(kPositionStep);
    tile.points.push_back(p);
    tile.voters.push_back(voter);
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
  EXPECT_EQ(again.voters, tile.voters);
  EXPECT_EQ(again.intensity, tile.intensity);
  ASSERT_EQ(again.points.size(), tile.points.size());
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
  tile.points[7].x += 1e-4F;
  tile.points[9].z = std::nanf("1");
  tile.points[11].y = -0.0F;
  tile.points[13].z = 1e30F;
  expect_every_bit_back(tile);
}

TEST(VotedTilePacking, BringsBackTensorsThatAreNotTheirVoters) {
  VotedTile tile = street_tile();
  tile.points[6].plate = 0.7F;
  expect_every_bit_back(tile);
  tile.points[6].mass = std::nanf("5");
  expect_every_bit_back(tile);
}

TEST(VotedTilePacking, BringsBackATileWhoseVotersAreNotKnown) {
  VotedTile tile = street_tile();
  tile.voters.clear();
  tile.intensity.clear();
  expect_every_bit_back(tile);
  expect_every_bit_back({});
}

}  // namespace
}  // namespace curbstone::semantic_map::tile
