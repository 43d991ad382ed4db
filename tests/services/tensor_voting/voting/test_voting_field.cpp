#include "services/tensor_voting/voting/voting_field.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <stdexcept>

#include "services/tensor_voting/voting/ball_vote.hpp"
#include "services/tensor_voting/voting/batch_voting.hpp"
#include "tests/services/tensor_voting/clouds.hpp"

namespace curbstone::tensor_voting::voting {
namespace {

using test_clouds::Tiles;
using SumsOfTiles = std::map<TileKey, std::vector<kernels::VoteSums>>;

/// The sums of every point, tile by tile.
SumsOfTiles contents(const VotingField& field, const test_clouds::Tiles& tiles) {
  SumsOfTiles result;
  for (const auto& [key, points] : tiles) {
    if (!field.contains(key)) continue;
    const std::vector<kernels::VoteSums> voters = field.sums(key);
    for (const std::uint32_t voter : field.voters_of_points(key)) result[key].push_back(voters[voter]);
  }
  return result;
}

/// Tile by tile, each at once.
SumsOfTiles in_order_of_tiles(const test_clouds::Tiles& tiles, const VotingParameters& parameters) {
  VotingField field(parameters);
  for (const auto& [key, points] : tiles) field.add(key, 0, points);
  return contents(field, tiles);
}

/// Adds the tiles' points in random pieces, tile after tile in random order.
void add_shuffled(VotingField& field, const test_clouds::Tiles& tiles, unsigned seed) {
  std::mt19937 random(seed);
  std::map<TileKey, std::size_t> next;
  std::vector<TileKey> open;
  for (const auto& [key, points] : tiles) open.push_back(key);
  while (!open.empty()) {
    const std::size_t pick = random() % open.size();
    const TileKey key = open[pick];
    const auto& points = tiles.at(key);
    const std::size_t count = std::min<std::size_t>(1 + random() % 200, points.size() - next[key]);
    field.add(key, 0, std::span(points).subspan(next[key], count));
    next[key] += count;
    if (next[key] == points.size()) open.erase(open.begin() + static_cast<std::ptrdiff_t>(pick));
  }
}

class Field : public ::testing::TestWithParam<VotingParameters> {};
INSTANTIATE_TEST_SUITE_P(Scales, Field,
                         ::testing::Values(VotingParameters{},
                                           VotingParameters{.sigma = 0.1, .radius = 0.3, .voxel = 0.05},
                                           VotingParameters{.sigma = 0.1, .radius = 0.25, .ball = 0.5, .voxel = 0},
                                           VotingParameters{.sigma = 1, .radius = 3, .ball = 0.6, .voxel = 0.3}));

TEST_P(Field, InAnyOrderHasTheSameBits) {
  const test_clouds::Tiles tiles = test_clouds::as_tiles(test_clouds::street(20'000, 1));
  const SumsOfTiles expected = in_order_of_tiles(tiles, GetParam());
  for (unsigned seed = 1; seed <= 3; ++seed) {
    VotingField field(GetParam());
    add_shuffled(field, tiles, seed);
    EXPECT_EQ(contents(field, tiles), expected) << "order " << seed;
  }
}

/// Changes far away, until everything else has fallen asleep.
void drive_on(VotingField& field, std::int64_t now) {
  const TilePoint point{700, 700, 0, 0};
  field.set_time(now);
  for (std::size_t i = 0; i <= field.num_tiles(); ++i) field.add({1000, 1000}, 0, std::span(&point, 1));
}

TEST_P(Field, WhatSleptHasTheSameBits) {
  test_clouds::Tiles tiles = test_clouds::as_tiles(test_clouds::street(8'000, 6));
  test_clouds::Tiles half;
  for (const auto& [key, points] : tiles)
    half[key].assign(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(points.size() / 2));
  VotingField field(GetParam());
  add_shuffled(field, half, 1);
  drive_on(field, VotingField::kAwake - 1);
  EXPECT_EQ(field.num_asleep(), 0);
  drive_on(field, VotingField::kAwake);
  EXPECT_EQ(field.num_asleep(), tiles.size());
  EXPECT_EQ(contents(field, half), in_order_of_tiles(half, GetParam()));
  EXPECT_EQ(field.num_asleep(), tiles.size()) << "asleep it can be read";
  for (const auto& [key, points] : tiles) field.add(key, 0, std::span(points).subspan(half[key].size()));
  EXPECT_EQ(contents(field, tiles), in_order_of_tiles(tiles, GetParam()));

  drive_on(field, 2 * VotingField::kAwake);
  std::int64_t blocks = 0;
  field.for_each_changed(tiles.begin()->first, 0, [&](const ReceivedBlock&) { ++blocks; });
  EXPECT_GT(blocks, 0);
  const TileKey gone = std::next(tiles.begin(), static_cast<std::ptrdiff_t>(tiles.size() / 2))->first;
  field.remove(gone);
  tiles.erase(gone);
  EXPECT_EQ(contents(field, tiles), in_order_of_tiles(tiles, GetParam()));
}

TEST_P(Field, SleepsAlsoWhileTheVehicleStands) {
  const test_clouds::Tiles tiles = test_clouds::as_tiles(test_clouds::street(2'000, 6));
  VotingField field(GetParam());
  add_shuffled(field, tiles, 1);
  for (std::size_t i = 0; i < tiles.size(); ++i) field.set_time(VotingField::kAwake);
  EXPECT_EQ(field.num_asleep(), tiles.size());
}

TEST_P(Field, RemovalLeavesTheBitsOfWhatRemains) {
  test_clouds::Tiles tiles = test_clouds::as_tiles(test_clouds::street(20'000, 2));
  VotingField field(GetParam());
  add_shuffled(field, tiles, 1);
  VotingField never(GetParam());
  test_clouds::Tiles kept;
  for (const auto& [key, points] : tiles) {
    if ((key.x + key.y) % 3 != 0) kept[key] = points;
  }
  for (const auto& [key, points] : tiles) {
    if (!kept.contains(key)) field.remove(key);
  }
  add_shuffled(never, kept, 2);
  EXPECT_EQ(contents(field, tiles), contents(never, kept));
  for (const auto& [key, points] : kept) EXPECT_EQ(field.num_votes(key), never.num_votes(key));
  for (const auto& [key, points] : tiles) {
    if (!kept.contains(key)) field.add(key, 0, points);
  }
  EXPECT_EQ(contents(field, tiles), in_order_of_tiles(tiles, GetParam())) << "and it can come back";
}

TEST_P(Field, EqualsTheBatch) {
  VotingParameters parameters = GetParam();
  parameters.radius *= 0.99999;  // no pair of whole steps lies at the very cut-off, where rounding would decide
  const test_clouds::Tiles tiles = test_clouds::as_tiles(test_clouds::street(20'000, 5));
  std::vector<Eigen::Vector3d> cloud;
  for (const auto& [key, points] : tiles) {
    for (const TilePoint& p : points) {
      const kernels::StepPoint in_map = test_clouds::in_map(key, p);
      cloud.push_back(Eigen::Vector3d(in_map.x, in_map.y, in_map.z) * kPositionStep);
    }
  }
  const CloudVotes votes = vote_cloud(cloud, parameters);
  std::size_t i = 0;
  for (const auto& [key, of_tile] : in_order_of_tiles(tiles, parameters)) {
    for (const kernels::VoteSums& sums : of_tile) {
      const Eigen::Matrix3d field = test_clouds::matrix(kernels::to_tensor(sums, parameters.ball));
      const Eigen::Matrix3d batch = test_clouds::matrix(votes.tensors[i++]);
      EXPECT_LE((field - batch).norm(), 3e-5 * batch.norm() + 2 * kernels::kVoteUnit);
    }
  }
}

TEST_P(Field, EqualsTheDoubleBruteForce) {
  const VotingParameters parameters = GetParam();
  const test_clouds::Tiles tiles = test_clouds::as_tiles(test_clouds::street(3'000, 3));
  VotingField field(parameters);
  std::vector<Eigen::Vector3d> voters;  // in steps
  std::vector<kernels::VoteSums> sums;
  for (const auto& [key, points] : tiles) field.add(key, 0, points);
  for (const auto& [key, points] : tiles) {
    const auto of_points = field.voters_of_points(key);
    const auto of_voters = field.sums(key);
    std::size_t next = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (of_points[i] != next) continue;
      const kernels::StepPoint p = test_clouds::in_map(key, points[i]);
      voters.emplace_back(p.x, p.y, p.z);
      sums.push_back(of_voters[next++]);
    }
    EXPECT_EQ(next, field.num_voters(key));
  }
  VotingParameters in_steps = parameters;
  in_steps.sigma = std::round(parameters.sigma / kPositionStep);
  in_steps.radius = std::round(parameters.radius / kPositionStep);
  const auto expected = vote_brute_force(voters, in_steps);
  for (std::size_t i = 0; i < voters.size(); ++i) {
    const kernels::Tensor t = kernels::to_tensor(sums[i], parameters.ball);
    if (expected[i].mass == 0) {
      EXPECT_EQ(t.mass, 0);
    } else {
      // kernels::kVoteUnit: more than 1e-5 of the very weakest votes only.
      const double norm = test_clouds::matrix(expected[i]).norm();
      EXPECT_LE(test_clouds::relative_difference(t, expected[i]), 1e-5 + 2 * kernels::kVoteUnit / norm) << i;
      EXPECT_NEAR(t.mass, expected[i].mass, 1e-5 * expected[i].mass + 2 * kernels::kVoteUnit);
    }
  }
}

TEST_P(Field, NamesTheTilesWhoseTensorsChange) {
  const test_clouds::Tiles tiles = test_clouds::as_tiles(test_clouds::street(6'000, 4));
  VotingField field(GetParam());
  add_shuffled(field, tiles, 1);
  EXPECT_EQ(field.take_changed().size(), tiles.size());
  EXPECT_TRUE(field.take_changed().empty());
  const SumsOfTiles before = contents(field, tiles);
  std::map<TileKey, std::int64_t> votes;
  for (const auto& [key, points] : tiles) votes[key] = field.num_votes(key);

  const TileKey touched{0, 0};
  field.add(touched, 0, std::vector<TilePoint>{{.x = 3, .y = 700, .z = 60}, {.x = 1490, .y = 1490, .z = 60}});
  const std::vector<TileKey> changed = field.take_changed();
  const SumsOfTiles after = contents(field, tiles);
  for (const auto& [key, points] : tiles) {
    const bool differs = after.at(key) != before.at(key);
    EXPECT_EQ(differs, std::find(changed.begin(), changed.end(), key) != changed.end());
    EXPECT_GE(field.num_votes(key), votes[key]);
    if (key == touched) continue;
    EXPECT_EQ(differs, field.num_votes(key) != votes[key]) << "votes count what happened to the tensors";
  }
}

TEST_P(Field, ShowsEveryVoterWhoseSumsHaveChanged) {
  const test_clouds::Tiles tiles = test_clouds::as_tiles(test_clouds::street(6'000, 4));
  VotingField field(GetParam());
  add_shuffled(field, tiles, 1);
  const auto shown_since = [&](TileKey key, std::int64_t since) {
    std::map<std::uint32_t, kernels::VoteSums> shown;
    field.for_each_changed(key, since, [&](const ReceivedBlock& received) {
      for (std::size_t lane = 0; lane < received.voters.size(); ++lane) {
        EXPECT_TRUE(shown.emplace(received.voters[lane], received.of(lane)).second) << "once";
      }
    });
    return shown;
  };
  std::map<TileKey, std::vector<kernels::VoteSums>> before;
  for (const auto& [key, points] : tiles) before[key] = field.sums(key);
  const std::int64_t since = field.change();
  field.add({0, 0}, 0, std::vector<TilePoint>{{.x = 3, .y = 700, .z = 60}, {.x = 1490, .y = 1490, .z = 60}});
  for (const auto& [key, points] : tiles) {
    const std::vector<kernels::VoteSums> after = field.sums(key);
    const auto all = shown_since(key, 0);
    const auto changed = shown_since(key, since);
    EXPECT_EQ(all.size(), after.size());
    for (std::uint32_t voter = 0; voter < after.size(); ++voter) {
      EXPECT_EQ(all.at(voter), after[voter]);
      const bool differs = voter >= before[key].size() || after[voter] != before[key][voter];
      EXPECT_TRUE(!differs || changed.contains(voter));
    }
    EXPECT_TRUE(shown_since(key, field.change()).empty());
  }
}

TEST(VotingField, ThinsByTheFirstPointOfAVoxel) {
  VotingField field({});
  field.add({0, 0}, 0,
            std::vector<TilePoint>{{.x = 1, .y = 1, .z = 1}, {.x = 2, .y = 2, .z = 2}, {.x = 60, .y = 2, .z = 2}});
  field.add({0, 0}, 0, std::vector<TilePoint>{{.x = 49, .y = 49, .z = 49}, {.x = 1, .y = 1, .z = -1}});
  EXPECT_EQ(std::vector<std::uint32_t>(field.voters_of_points({0, 0}).begin(), field.voters_of_points({0, 0}).end()),
            (std::vector<std::uint32_t>{0, 0, 1, 0, 2}));
  EXPECT_EQ(field.num_votes({0, 0}), 6) << "three voters, all pairs, both ends";
}

TEST(VotingField, HeightsOfNeighbourTilesMeetAcrossTheirOrigins) {
  VotingField flat({});
  VotingField stepped({});
  const std::vector<TilePoint> edge{{.x = 1499, .y = 10, .z = 500}};
  flat.add({0, 0}, 0, edge);
  flat.add({1, 0}, 0, std::vector<TilePoint>{{.x = 0, .y = 10, .z = 450}});
  stepped.add({0, 0}, 0, edge);
  stepped.add({1, 0}, 500, std::vector<TilePoint>{{.x = 0, .y = 10, .z = -50}});
  EXPECT_EQ(flat.sums({0, 0}), stepped.sums({0, 0}));
  EXPECT_EQ(flat.num_votes({0, 0}), 1);
}

TEST(VotingField, AMillionPointsInOneVoxelAreOneVoter) {
  VotingField field({});
  std::vector<TilePoint> heap(1'000'000);
  for (std::size_t i = 0; i < heap.size(); ++i) heap[i].x = static_cast<std::int16_t>(i % 50);
  field.add({0, 0}, 0, heap);
  EXPECT_EQ(field.num_points({0, 0}), heap.size());
  EXPECT_EQ(field.num_voters({0, 0}), 1U);
  EXPECT_EQ(field.sums({0, 0})[0], kernels::VoteSums{});
}

TEST(VotingField, FarTilesAreAsGoodAsNearOnes) {
  const test_clouds::Tiles tiles = test_clouds::as_tiles(test_clouds::street(3'000, 6));
  VotingField here({});
  VotingField there({});
  const TileKey far{1'431'000, -1'431'655};  // 4300 km: positions wrap
  test_clouds::Tiles moved;
  for (const auto& [key, points] : tiles) moved[{key.x + far.x, key.y + far.y}] = points;
  add_shuffled(here, tiles, 1);
  add_shuffled(there, moved, 1);
  const auto a = contents(here, tiles);
  const auto b = contents(there, moved);
  for (const auto& [key, sums] : a) EXPECT_EQ(sums, b.at({key.x + far.x, key.y + far.y}));
}

TEST(VotingField, RefusesWhatItCannotDo) {
  EXPECT_THROW(VotingField({.sigma = 0}), std::invalid_argument);
  EXPECT_THROW(VotingField({.radius = 3.1}), std::invalid_argument);
  EXPECT_THROW(VotingField({.voxel = 0.07}), std::invalid_argument) << "does not divide a tile";
  EXPECT_THROW(VotingField({.voxel = 0.001}), std::invalid_argument) << "finer than a step";
  VotingField field({});
  field.add({0, 0}, 0, {});
  field.remove({0, 0});
  EXPECT_EQ(field.num_tiles(), 0U);
}

}  // namespace
}  // namespace curbstone::tensor_voting::voting
