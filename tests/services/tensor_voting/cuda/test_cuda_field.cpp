// The growing map on a GPU; and the same source run by the host in its place, so that it is tested where there is none.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>
#include <stdexcept>

#include "services/tensor_voting/cuda/cuda_voting.hpp"
#include "services/tensor_voting/cuda/cuda_voting_field.hpp"
#include "services/tensor_voting/cuda/field_pipeline.hpp"
#include "services/tensor_voting/voting/voting_field.hpp"
#include "tests/services/tensor_voting/clouds.hpp"
#include "tests/services/tensor_voting/cuda/cuda_host_machine.hpp"

namespace curbstone::tensor_voting::cuda {
namespace {

using test_clouds::Tiles;

CudaVotingField::MakeVoters in_the_devices_place(std::size_t most_elements = 0) {
  return [most_elements](const cuda::CellGrid& grid, const kernels::Decay& decay) {
    return std::make_unique<cuda::ResidentVotersOn<cuda::HostMachine>>(cuda::HostMachine{most_elements}, grid, decay);
  };
}

class CudaField : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (on_device() && !cuda_available()) GTEST_SKIP() << "not run on a GPU: " << why_no_cuda();
  }
  [[nodiscard]] static bool on_device() { return std::strcmp(GetParam(), "OnTheDevice") == 0; }
  [[nodiscard]] static CudaVotingField field(const voting::VotingParameters& parameters,
                                             std::size_t max_voters = 1'000'000) {
    return on_device() ? CudaVotingField(parameters, max_voters)
                       : CudaVotingField(parameters, max_voters, in_the_devices_place());
  }
};
INSTANTIATE_TEST_SUITE_P(Run, CudaField, ::testing::Values("InItsPlace", "OnTheDevice"),
                         [](const auto& run) { return run.param; });

const std::vector<voting::VotingParameters>& scales() {
  static const std::vector<voting::VotingParameters> kScales{{},
                                                             {.sigma = 0.1, .radius = 0.3, .voxel = 0.05},
                                                             {.sigma = 0.1, .radius = 0.25, .ball = 0.5, .voxel = 0},
                                                             {.sigma = 1, .radius = 3, .ball = 0.6, .voxel = 0.3}};
  return kScales;
}

/// Sums, voters and versions have the bits of the CPU's.
void expect_same(CudaVotingField& field, const voting::VotingField& expected, const test_clouds::Tiles& tiles) {
  ASSERT_EQ(field.num_tiles(), expected.num_tiles());
  for (const auto& [key, points] : tiles) {
    ASSERT_EQ(field.contains(key), expected.contains(key));
    ASSERT_EQ(field.num_points(key), expected.num_points(key));
    ASSERT_EQ(field.num_voters(key), expected.num_voters(key));
    EXPECT_TRUE(std::ranges::equal(field.voters_of_points(key), expected.voters_of_points(key)));
    const CudaVotingField::TileVotes votes = field.votes(key);
    EXPECT_EQ(votes.sums, expected.sums(key)) << key.x << ", " << key.y;
    EXPECT_EQ(votes.num_votes, expected.num_votes(key));
  }
}

voting::VotingField on_the_cpu(const voting::VotingParameters& parameters, const test_clouds::Tiles& tiles) {
  voting::VotingField field(parameters);
  for (const auto& [key, points] : tiles) field.add(key, 0, points);
  return field;
}

/// Adds the tiles' points in batches of random pieces of random tiles.
void add_shuffled(CudaVotingField& field, const test_clouds::Tiles& tiles, unsigned seed) {
  std::mt19937 random(seed);
  std::map<TileKey, std::size_t> next;
  std::vector<TileKey> open;
  for (const auto& [key, points] : tiles) open.push_back(key);
  while (!open.empty()) {
    std::vector<CudaVotingField::Addition> batch;
    for (int i = 0; i < 12 && !open.empty(); ++i) {
      const std::size_t pick = random() % open.size();
      const TileKey key = open[pick];
      const auto& points = tiles.at(key);
      const std::size_t count = std::min<std::size_t>(1 + random() % 200, points.size() - next[key]);
      batch.push_back({key, 0, std::span(points).subspan(next[key], count)});
      next[key] += count;
      if (next[key] == points.size()) open.erase(open.begin() + static_cast<std::ptrdiff_t>(pick));
    }
    field.add(batch);
  }
}

TEST_P(CudaField, InAnyOrderHasTheBitsOfTheCpus) {
  const test_clouds::Tiles tiles = test_clouds::as_tiles(test_clouds::street(4'000, 1));
  for (const voting::VotingParameters& parameters : scales()) {
    const voting::VotingField expected = on_the_cpu(parameters, tiles);
    for (unsigned seed = 1; seed <= 2; ++seed) {
      CudaVotingField growing = field(parameters);
      add_shuffled(growing, tiles, seed);
      expect_same(growing, expected, tiles);
    }
  }
}

TEST_P(CudaField, AllAtOnceAndManyTilesInOneDownload) {
  const test_clouds::Tiles tiles = test_clouds::as_tiles(test_clouds::street(4'000, 7));
  std::vector<CudaVotingField::Addition> all;
  std::vector<TileKey> keys{{1000, 1000}};  // not there
  for (const auto& [key, points] : tiles) {
    all.push_back({key, 0, points});
    keys.push_back(key);
  }
  keys.push_back(keys[1]);  // twice
  CudaVotingField at_once = field({});
  at_once.add(all);
  const voting::VotingField expected = on_the_cpu({}, tiles);
  const auto votes = at_once.votes(keys);
  ASSERT_EQ(votes.size(), keys.size());
  EXPECT_TRUE(votes[0].sums.empty());
  for (std::size_t i = 1; i < keys.size(); ++i) EXPECT_EQ(votes[i].sums, expected.sums(keys[i]));
}

TEST_P(CudaField, RemovalLeavesTheBitsOfWhatRemains) {
  const test_clouds::Tiles tiles = test_clouds::as_tiles(test_clouds::street(4'000, 2));
  for (const voting::VotingParameters& parameters : scales()) {
    CudaVotingField changing = field(parameters);
    add_shuffled(changing, tiles, 1);
    test_clouds::Tiles kept;
    std::vector<TileKey> removed;
    for (const auto& [key, points] : tiles) {
      if ((key.x + key.y) % 3 != 0) {
        kept[key] = points;
      } else {
        removed.push_back(key);
      }
    }
    changing.remove(removed.back());
    removed.pop_back();
    changing.remove(removed);
    expect_same(changing, on_the_cpu(parameters, kept), tiles);
    for (const auto& [key, points] : tiles) {
      if (!kept.contains(key)) changing.add(key, 0, points);
    }
    expect_same(changing, on_the_cpu(parameters, tiles), tiles);
    for (const auto& [key, points] : tiles) changing.remove(key);
    EXPECT_EQ(changing.num_voters(), 0U);
  }
}

TEST_P(CudaField, NamesTheTilesWhoseTensorsChange) {
  const test_clouds::Tiles tiles = test_clouds::as_tiles(test_clouds::street(3'000, 4));
  CudaVotingField ours = field({});
  voting::VotingField expected({});
  for (const auto& [key, points] : tiles) {
    ours.add(key, 0, points);
    expected.add(key, 0, points);
    EXPECT_EQ(ours.take_changed(), expected.take_changed());
  }
  const std::vector<TilePoint> corner{{.x = 3, .y = 700, .z = 60}, {.x = 1490, .y = 1490, .z = 60}};
  ours.add({0, 0}, 0, corner);
  expected.add({0, 0}, 0, corner);
  EXPECT_EQ(ours.take_changed(), expected.take_changed());
  ours.remove({0, 0});
  expected.remove({0, 0});
  EXPECT_EQ(ours.take_changed(), expected.take_changed());
  EXPECT_TRUE(ours.take_changed().empty());
}

TEST_P(CudaField, FarTilesAreAsGoodAsNearOnes) {
  const test_clouds::Tiles tiles = test_clouds::as_tiles(test_clouds::street(2'000, 6));
  const TileKey far{1'431'000, -1'431'655};  // 4300 km: positions wrap
  test_clouds::Tiles moved;
  for (const auto& [key, points] : tiles) moved[{key.x + far.x, key.y + far.y}] = points;
  CudaVotingField there = field({});
  add_shuffled(there, moved, 1);
  expect_same(there, on_the_cpu({}, moved), moved);
  EXPECT_THROW(there.add({0, 0}, 0, tiles.begin()->second), std::invalid_argument) << "too far from the others";
  expect_same(there, on_the_cpu({}, moved), moved);
  there.clear();
  there.add({0, 0}, 0, tiles.begin()->second);
  EXPECT_EQ(there.num_tiles(), 1U);
}

TEST_P(CudaField, HeightsOfNeighbourTilesMeetAcrossTheirOrigins) {
  CudaVotingField ours = field({});
  voting::VotingField expected({});
  const std::vector<TilePoint> left{{.x = 1499, .y = 10, .z = 500}};
  const std::vector<TilePoint> right{{.x = 0, .y = 10, .z = -50}};
  ours.add({0, 0}, 0, left);
  ours.add({1, 0}, 500, right);
  expected.add({0, 0}, 0, left);
  expected.add({1, 0}, 500, right);
  EXPECT_EQ(ours.votes({0, 0}).sums, expected.sums({0, 0}));
  EXPECT_EQ(ours.votes({0, 0}).num_votes, 1);
}

TEST_P(CudaField, AMillionPointsInOneVoxelAreOneVoter) {
  CudaVotingField ours = field({});
  std::vector<TilePoint> heap(1'000'000);
  for (std::size_t i = 0; i < heap.size(); ++i) heap[i].x = static_cast<std::int16_t>(i % 50);
  ours.add({0, 0}, 0, heap);
  EXPECT_EQ(ours.num_points({0, 0}), heap.size());
  EXPECT_EQ(ours.num_voters(), 1U);
  EXPECT_EQ(ours.votes({0, 0}).sums[0], kernels::VoteSums{});
}

TEST_P(CudaField, RefusesWhatItCannotDo) {
  EXPECT_THROW(field({.sigma = 0}), std::invalid_argument);
  EXPECT_THROW(field({.radius = 3.1}), std::invalid_argument);
  EXPECT_THROW(field({.voxel = 0.07}), std::invalid_argument) << "does not divide a tile";
  CudaVotingField ours = field({}, 3);
  ours.add({0, 0}, 0, {});
  ours.remove({0, 0});
  EXPECT_EQ(ours.num_tiles(), 0U);
  EXPECT_THROW(ours.add({0, 0}, 0, std::vector<TilePoint>{{.x = -1}}), std::invalid_argument);
  EXPECT_THROW(ours.add({0, 0}, 0, std::vector<TilePoint>{{.y = 1500}}), std::invalid_argument);
  EXPECT_THROW(ours.add({0, 0}, 2'147'483'647, std::vector<TilePoint>{{.z = 1}}), std::invalid_argument);
  EXPECT_EQ(ours.num_tiles(), 0U);
  ours.add({0, 0}, 0, std::vector<TilePoint>{{.x = 1}, {.x = 101}});
  EXPECT_THROW(ours.add({1, 0}, 0, std::vector<TilePoint>{{.x = 1}, {.x = 101}}), std::runtime_error) << "full";
  EXPECT_EQ(ours.num_voters(), 2U) << "nothing has changed";
}

TEST(CudaFieldInItsPlace, IsEmptyAfterTheMachineHasFailed) {
  CudaVotingField field({.voxel = 0}, 1'000'000, in_the_devices_place(150));
  const std::vector<TilePoint> hundred(100, TilePoint{.x = 1, .y = 2, .z = 3});
  field.add({0, 0}, 0, hundred);
  EXPECT_THROW(field.add({1, 0}, 0, hundred), std::runtime_error);
  EXPECT_EQ(field.num_tiles(), 0U);
  EXPECT_EQ(field.num_voters(), 0U);
  field.add({1, 0}, 0, hundred);
  EXPECT_EQ(field.votes({1, 0}).sums.size(), 100U);
}

TEST(CudaFieldWithoutADevice, SaysWhy) {
  if (cuda_available()) GTEST_SKIP() << "there is a GPU";
  EXPECT_THROW(CudaVotingField({}), std::runtime_error);
}

}  // namespace
}  // namespace curbstone::tensor_voting::cuda
