#include "services/tensor_voting/kernels/vote_kernel.hpp"

#include <gtest/gtest.h>

#include <random>

#include "services/tensor_voting/kernels/tensor_block.hpp"
#include "services/tensor_voting/voting/ball_vote.hpp"
#include "tests/services/tensor_voting/clouds.hpp"

namespace curbstone::tensor_voting::kernels {
namespace {

constexpr voting::VotingParameters kParameters{.sigma = 0.3, .radius = 0.9, .ball = 1, .voxel = 0};
const Decay kDecay = decay_in_steps(0.3, 0.9, kPositionStep);

struct Voters {
  std::vector<StepPoint> points;
  std::vector<VoterBlock> blocks;
  std::vector<SettledSums> settled;

  void push_back(const StepPoint& p) {
    if (points.size() % kLanes == 0) {
      blocks.emplace_back();
      settled.emplace_back();
    }
    blocks.back().push_back(p);
    points.push_back(p);
  }
  [[nodiscard]] VoteSums sums(std::size_t i) const {
    return sums_of(blocks[i / kLanes], settled[i / kLanes], i % kLanes);
  }
};
Voters random_voters(std::size_t count, const StepPoint& around, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> offset(-480, 480);
  Voters voters;
  const auto wrap = [](std::int32_t a, int b) {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) + static_cast<std::uint32_t>(b));
  };
  for (std::size_t i = 0; i < count; ++i) {
    voters.push_back({wrap(around.x, offset(random)), wrap(around.y, offset(random)), wrap(around.z, offset(random))});
  }
  return voters;
}

std::int64_t exchange(const VoteKernel& kernel, const StepPoint& at, float sign, Voters& voters, VoteSums& sums) {
  std::vector<NearBlock> near;
  for (std::size_t i = 0; i < voters.blocks.size(); ++i) near.push_back({&voters.blocks[i], &voters.settled[i], 0});
  const std::int64_t pairs = kernel.exchange(kDecay, at, sign, near.data(), near.size(), sums.value.data());
  std::int64_t of_blocks = 0;
  for (const NearBlock& block : near) of_blocks += block.pairs;
  EXPECT_EQ(of_blocks, pairs);
  return pairs;
}

class Kernel : public ::testing::TestWithParam<VoteKernel> {};
INSTANTIATE_TEST_SUITE_P(InstructionSets, Kernel, ::testing::ValuesIn(vote_kernels().begin(), vote_kernels().end()),
                         [](const auto& kernel) { return kernel.param.name; });

std::vector<VoteSums> received(const Voters& voters) {
  std::vector<VoteSums> sums;
  for (std::size_t i = 0; i < voters.points.size(); ++i) sums.push_back(voters.sums(i));
  return sums;
}

TEST_P(Kernel, EveryInstructionSetGivesTheSameBits) {
  for (const std::size_t count : {1U, 15U, 16U, 17U, 64U, 333U}) {
    Voters expected_voters = random_voters(count, {0, 0, 0}, 3);
    Voters voters = expected_voters;
    VoteSums expected;
    VoteSums sums;
    for (int i = 0; i < 40; ++i) {  // so often that the short sums must settle
      const StepPoint at{i, 2 * i, 3};
      const auto pairs = exchange(vote_kernels().back(), at, 1, expected_voters, expected);
      EXPECT_EQ(exchange(GetParam(), at, 1, voters, sums), pairs);
      EXPECT_EQ(sums, expected);
    }
    EXPECT_EQ(received(voters), received(expected_voters));
  }
}

TEST_P(Kernel, BothEndsOfAPairReceiveTheSameVote) {
  Voters voters = random_voters(1, {200, 100, -50}, 9);
  VoteSums sums;
  ASSERT_EQ(exchange(GetParam(), {0, 0, 0}, 1, voters, sums), 1);
  for (std::size_t c = 0; c < VoteSums::kCount; ++c) {
    EXPECT_NE(sums.value[c], 0);
    EXPECT_EQ(voters.sums(0).value[c], sums.value[c]);
    for (std::size_t lane = 1; lane < kLanes; ++lane) EXPECT_EQ(voters.sums(lane).value[c], 0);
  }
  ASSERT_EQ(exchange(GetParam(), {0, 0, 0}, -1, voters, sums), 1);
  EXPECT_EQ(sums, VoteSums{}) << "taking back leaves nothing";
  EXPECT_EQ(voters.sums(0), VoteSums{});
}

TEST_P(Kernel, WhatIsTakenBackLeavesNothingHoweverOftenItSettled) {
  Voters voters = random_voters(64, {0, 0, 0}, 4);
  VoteSums sums;
  for (const float sign : {-1.0F, 1.0F, 1.0F, -1.0F}) {  // the sums go below zero, too
    for (int i = 0; i < 1000; ++i) exchange(GetParam(), {i % 30, 7, i % 11}, sign, voters, sums);
  }
  EXPECT_EQ(sums, VoteSums{});
  for (const VoteSums& of_voter : received(voters)) EXPECT_EQ(of_voter, VoteSums{});
}

TEST(SettledSums, HoldWhatTheyAreSetTo) {
  VoterBlock block;
  SettledSums settled;
  const VoteSums sums{{(std::int64_t{1} << 54) + 12345, -1, 0, 1, -(std::int64_t{1} << 54), kLessThanSettled}};
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    set_sums(sums, block, settled, lane);
    EXPECT_EQ(sums_of(block, settled, lane), sums);
    for (const auto& recent : block.recent) {
      EXPECT_GE(recent[lane], 0);
      EXPECT_LE(recent[lane], kLessThanSettled) << "kMaxRecent votes fit beside it";
    }
  }
}

TEST_P(Kernel, AVoteIsTheReferenceVoteAtEveryDistance) {
  std::mt19937 random(11);
  std::uniform_int_distribution<int> offset(-300, 300);
  for (int i = 0; i < 3000; ++i) {
    StepPoint p{offset(random), offset(random), offset(random)};
    if (i < 450) p = {i, 0, 0};
    Voters one;
    one.push_back(p);
    VoteSums sums;
    exchange(GetParam(), {0, 0, 0}, 1, one, sums);
    voting::VotingParameters in_steps = kParameters;
    in_steps.sigma = 150;
    in_steps.radius = 450;
    Tensor expected;
    voting::add_ball_vote({double(p.x), double(p.y), double(p.z)}, in_steps, expected);
    const Tensor vote = to_tensor(sums, 1);
    EXPECT_NEAR(vote.mass, expected.mass, 1e-6 * expected.mass + kVoteUnit) << p.x << " " << p.y << " " << p.z;
    if (expected.mass > 0) {
      EXPECT_LE((test_clouds::matrix(vote) - test_clouds::matrix(expected)).norm(),
                1e-6 * expected.mass + 2 * kVoteUnit);
    } else {
      EXPECT_EQ(sums, VoteSums{});
    }
  }
}

TEST_P(Kernel, FarFromTheOriginNothingIsLost) {
  Voters near = random_voters(100, {0, 0, 0}, 5);
  VoteSums expected;
  exchange(GetParam(), {0, 0, 0}, 1, near, expected);
  for (const StepPoint& origin : {StepPoint{500'000'000, -500'000'000, 7}, StepPoint{2147483647, -2147483647 - 1, 0}}) {
    Voters far = random_voters(100, origin, 5);
    VoteSums sums;
    exchange(GetParam(), origin, 1, far, sums);
    EXPECT_EQ(sums, expected) << "coordinates wrap, differences do not";
    EXPECT_EQ(received(far), received(near));
  }
}

TEST_P(Kernel, ManyVotersDoNotOverflow) {
  constexpr int kCount = 1'000'000;
  Voters crowd;
  for (int i = 0; i < kLanes; ++i) crowd.push_back({1, 0, 0});
  VoteSums sums;
  for (int i = 0; i < kCount / kLanes; ++i) exchange(GetParam(), {0, 0, 0}, 1, crowd, sums);
  const double w = std::exp(-1.0 / 22500);
  EXPECT_NEAR(to_tensor(sums, 1).mass, kCount * w, 1e-6 * kCount);
  EXPECT_NEAR(to_tensor(crowd.sums(3), 1).mass, kCount / kLanes * w, 1e-6 * kCount / kLanes);
}

TEST_P(Kernel, TakesTensorsApartAsTheReferenceDoes) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  std::vector<TensorBlock> tensors(101);
  std::vector<Tensor> exact;
  for (std::size_t i = 0; i < tensors.size() * kLanes; ++i) {
    Eigen::Matrix3d b;
    for (int k = 0; k < 9; ++k) b(k / 3, k % 3) = normal(random);
    if (i % 3 == 0) b.col(2) *= 1e-3;  // nearly a line
    if (i % 5 == 0) b.col(1) = b.col(0);
    const Eigen::Matrix3f m = (b * b.transpose() * std::pow(10.0, 3 * normal(random))).cast<float>();
    tensors[i / kLanes].set(i % kLanes, {m(0, 0), m(0, 1), m(0, 2), m(1, 1), m(1, 2), m(2, 2), 1});
    const auto wide = [&](int r, int c) { return static_cast<double>(m(r, c)); };
    exact.push_back({wide(0, 0), wide(0, 1), wide(0, 2), wide(1, 1), wide(1, 2), wide(2, 2), 1});
  }
  std::vector<ShapeBlock> shapes(tensors.size());
  GetParam().decompose(tensors[0].component, shapes[0].component, tensors.size());
  std::vector<ShapeBlock> baseline(tensors.size());
  vote_kernels().back().decompose(tensors[0].component, baseline[0].component, tensors.size());
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const DecompositionF d = shapes[i / kLanes].get(i % kLanes, 1);
    const DecompositionF same = baseline[i / kLanes].get(i % kLanes, 1);
    EXPECT_TRUE(d.normal == same.normal && d.tangent == same.tangent && d.stick == same.stick &&
                d.plate == same.plate && d.ball == same.ball);
    const Decomposition expected = decompose(exact[i]);
    EXPECT_NEAR(static_cast<double>(d.stick), expected.stick, 2e-6);
    EXPECT_NEAR(static_cast<double>(d.plate), expected.plate, 2e-6);
    EXPECT_NEAR(static_cast<double>(d.ball), expected.ball, 2e-6);
    // A direction is as sure as its eigenvalue is alone.
    const auto angle = [](const Eigen::Vector3f& a, const Eigen::Vector3d& b) {
      return std::min((a.cast<double>() - b).norm(), (a.cast<double>() + b).norm());
    };
    EXPECT_LE(angle(d.normal, expected.normal) * expected.stick, 4e-6);
    EXPECT_LE(angle(d.tangent, expected.tangent) * expected.plate, 4e-6);
    EXPECT_GE(d.normal.z(), 0);
    EXPECT_GE(d.tangent.z(), 0);
  }
}

}  // namespace
}  // namespace curbstone::tensor_voting::kernels
