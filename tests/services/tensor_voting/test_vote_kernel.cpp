#include "services/tensor_voting/vote_kernel.hpp"

#include <gtest/gtest.h>

#include <random>

#include "services/tensor_voting/ball_vote.hpp"
#include "tests/services/tensor_voting/clouds.hpp"

namespace curbstone {
namespace {

constexpr VotingParameters kParameters{.sigma = 0.3, .radius = 0.9, .ball = 1, .voxel = 0};
const Decay kDecay = decay_in_steps(0.3, 0.9, kPositionStep);

struct Voters {
  std::vector<StepPoint> points;
  std::vector<std::int32_t> x, y, z;
  std::vector<VoterBlock> blocks;
};
Voters random_voters(std::size_t count, const StepPoint& around, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> offset(-480, 480);
  Voters voters;
  const auto wrap = [](std::int32_t a, int b) {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) + static_cast<std::uint32_t>(b));
  };
  for (std::size_t i = 0; i < count; ++i) {
    const StepPoint p{wrap(around.x, offset(random)), wrap(around.y, offset(random)), wrap(around.z, offset(random))};
    voters.points.push_back(p);
    voters.x.push_back(p.x), voters.y.push_back(p.y), voters.z.push_back(p.z);
    if (i % kLanes == 0) {
      voters.blocks.emplace_back();
      voters.blocks.back().x.fill(nowhere_near(p.x));
      voters.blocks.back().y.fill(p.y);
      voters.blocks.back().z.fill(p.z);
      for (auto& lane : voters.blocks.back().sums) lane.fill(0);
    }
    voters.blocks.back().x[i % kLanes] = p.x;
    voters.blocks.back().y[i % kLanes] = p.y;
    voters.blocks.back().z[i % kLanes] = p.z;
  }
  for (auto* v : {&voters.x, &voters.y, &voters.z}) v->resize(count + kLanes);
  return voters;
}

std::int64_t exchange(const VoteKernel& kernel, const StepPoint& at, float sign, std::vector<VoterBlock>& blocks,
                      VoteSums& sums) {
  // In two ranges, as if the blocks lay in two cells.
  const std::size_t half = blocks.size() / 2;
  BlockRange ranges[] = {{blocks.data(), half, 0}, {blocks.data() + half, blocks.size() - half, 0}};
  kernel.exchange(kDecay, at, sign, ranges, 2, sums.value.data());
  return ranges[0].pairs + ranges[1].pairs;
}

class Kernel : public ::testing::TestWithParam<VoteKernel> {};
INSTANTIATE_TEST_SUITE_P(InstructionSets, Kernel, ::testing::ValuesIn(vote_kernels().begin(), vote_kernels().end()),
                         [](const auto& kernel) { return kernel.param.name; });

TEST_P(Kernel, GatherAndExchangeAndEveryInstructionSetGiveTheSameBits) {
  for (const std::size_t count : {1U, 7U, 8U, 9U, 64U, 333U}) {
    Voters voters = random_voters(count, {0, 0, 0}, 3);
    VoteSums expected;
    const auto pairs = vote_kernels().back().gather(kDecay, {1, 2, 3}, voters.x.data(), voters.y.data(),
                                                    voters.z.data(), count, expected.value.data());
    VoteSums gathered;
    EXPECT_EQ(GetParam().gather(kDecay, {1, 2, 3}, voters.x.data(), voters.y.data(), voters.z.data(), count,
                                gathered.value.data()),
              pairs);
    EXPECT_EQ(gathered, expected);
    VoteSums exchanged;
    EXPECT_EQ(exchange(GetParam(), {1, 2, 3}, 1, voters.blocks, exchanged), pairs);
    EXPECT_EQ(exchanged, expected);
  }
}

TEST_P(Kernel, BothEndsOfAPairReceiveTheSameVote) {
  Voters voters = random_voters(1, {200, 100, -50}, 9);
  VoteSums sums;
  ASSERT_EQ(exchange(GetParam(), {0, 0, 0}, 1, voters.blocks, sums), 1);
  for (std::size_t c = 0; c < VoteSums::kCount; ++c) {
    EXPECT_NE(sums.value[c], 0);
    EXPECT_EQ(voters.blocks[0].sums[c][0], sums.value[c]);
    for (std::size_t lane = 1; lane < kLanes; ++lane) EXPECT_EQ(voters.blocks[0].sums[c][lane], 0);
  }
  ASSERT_EQ(exchange(GetParam(), {0, 0, 0}, -1, voters.blocks, sums), 1);
  EXPECT_EQ(sums, VoteSums{}) << "taking back leaves nothing";
  EXPECT_EQ(voters.blocks[0].sums[0][0], 0);
}

TEST_P(Kernel, AVoteIsTheReferenceVoteAtEveryDistance) {
  std::mt19937 random(11);
  std::uniform_int_distribution<int> offset(-300, 300);
  for (int i = 0; i < 3000; ++i) {
    StepPoint p{offset(random), offset(random), offset(random)};
    if (i < 450) p = {i, 0, 0};
    const Voters one = [&] {
      Voters v;
      v.x.assign(1 + kLanes, p.x), v.y.assign(1 + kLanes, p.y), v.z.assign(1 + kLanes, p.z);
      return v;
    }();
    VoteSums sums;
    GetParam().gather(kDecay, {0, 0, 0}, one.x.data(), one.y.data(), one.z.data(), 1, sums.value.data());
    VotingParameters in_steps = kParameters;
    in_steps.sigma = 150;
    in_steps.radius = 450;
    Tensor expected;
    add_ball_vote({double(p.x), double(p.y), double(p.z)}, in_steps, expected);
    const Tensor vote = to_tensor(sums, 1);
    EXPECT_NEAR(vote.mass, expected.mass, 1e-6 * expected.mass + kVoteUnit) << p.x << " " << p.y << " " << p.z;
    if (expected.mass > 0) {
      EXPECT_LE((testing_clouds::matrix(vote) - testing_clouds::matrix(expected)).norm(), 1e-6 * expected.mass + 3e-9);
    } else {
      EXPECT_EQ(sums, VoteSums{});
    }
  }
}

TEST_P(Kernel, FarFromTheOriginNothingIsLost) {
  const Voters near = random_voters(100, {0, 0, 0}, 5);
  VoteSums expected;
  GetParam().gather(kDecay, {0, 0, 0}, near.x.data(), near.y.data(), near.z.data(), 100, expected.value.data());
  for (const StepPoint& origin : {StepPoint{500'000'000, -500'000'000, 7}, StepPoint{2147483647, -2147483647 - 1, 0}}) {
    const Voters far = random_voters(100, origin, 5);
    VoteSums sums;
    GetParam().gather(kDecay, origin, far.x.data(), far.y.data(), far.z.data(), 100, sums.value.data());
    EXPECT_EQ(sums, expected) << "coordinates wrap, differences do not";
  }
}

TEST_P(Kernel, ManyVotersDoNotOverflow) {
  constexpr std::size_t kCount = 1'000'000;
  const std::vector<std::int32_t> x(kCount + kLanes, 1);
  const std::vector<std::int32_t> zero(kCount + kLanes, 0);
  VoteSums sums;
  EXPECT_EQ(GetParam().gather(kDecay, {0, 0, 0}, x.data(), zero.data(), zero.data(), kCount, sums.value.data()),
            std::int64_t{kCount});
  EXPECT_NEAR(to_tensor(sums, 1).mass, kCount * std::exp(-1.0 / 22500), 1);
}

}  // namespace
}  // namespace curbstone
