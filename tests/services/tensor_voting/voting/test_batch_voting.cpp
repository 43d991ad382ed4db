#include "services/tensor_voting/voting/batch_voting.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstring>
#include <limits>
#include <numbers>
#include <random>

#include "services/tensor_voting/kernels/batch_kernel.hpp"
#include "services/tensor_voting/voting/ball_vote.hpp"
#include "services/tensor_voting/voting/step_cloud.hpp"
#include "tests/services/tensor_voting/clouds.hpp"

namespace curbstone::tensor_voting::voting {
namespace {

using test_clouds::matrix;
using test_clouds::relative_difference;

/// On the same whole steps: a pair at the cut-off must not fall on either side of it by chance.
void expect_equal_to_brute_force(const std::vector<Eigen::Vector3d>& points, VotingParameters parameters) {
  parameters.voxel = 0;
  const StepCloud cloud = to_steps(points, parameters.sigma);
  std::vector<Eigen::Vector3d> in_steps;
  for (const WidePoint& p : cloud.points) in_steps.emplace_back(p.x, p.y, p.z);
  VotingParameters scaled = parameters;
  scaled.sigma /= cloud.step;
  scaled.radius /= cloud.step;
  const auto expected = vote_brute_force(in_steps, scaled);
  const auto votes = vote_cloud(points, parameters, 2);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_LE((test_clouds::matrix(votes.tensors[i]) - test_clouds::matrix(expected[i])).norm(),
              1e-5 * test_clouds::matrix(expected[i]).norm())
        << i;
    EXPECT_NEAR(votes.tensors[i].mass, expected[i].mass, 1e-5 * expected[i].mass);
  }
}

TEST(BatchVoting, OfAPlaneLatticeIsExact) {
  std::vector<Eigen::Vector3d> points;
  for (int x = -24; x <= 24; ++x) {
    for (int y = -24; y <= 24; ++y) points.emplace_back(0.1 * x, 0.1 * y, 0);
  }
  const CloudVotes votes = vote_cloud(points, {.radius = 2.4, .voxel = 0});
  const kernels::TensorF& t = votes.tensors[24 * 49 + 24];
  const double w = std::numbers::pi * 0.09 / 0.01 - 1;
  EXPECT_NEAR(t.mass, w, 1e-5 * w);
  EXPECT_LE((test_clouds::matrix(t) - w * Eigen::Vector3d(0.5, 0.5, 1).asDiagonal().toDenseMatrix()).norm(), 1e-5 * w);
}

TEST(BatchVoting, EqualsBruteForceOnStreetRandomAndDegenerateClouds) {
  expect_equal_to_brute_force(test_clouds::street(3'000, 1), {});
  expect_equal_to_brute_force(test_clouds::street(3'000, 2), {.sigma = 0.1, .radius = 0.3, .ball = 0.5});
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<Eigen::Vector3d> cube(2000);
  for (auto& p : cube) p = {unit(random), unit(random), unit(random)};
  expect_equal_to_brute_force(cube, {});
  std::vector<Eigen::Vector3d> line;
  for (int i = 0; i < 500; ++i) line.emplace_back(unit(random), 0, 0);
  expect_equal_to_brute_force(line, {});
  expect_equal_to_brute_force({{0, 0, 0}}, {});
  expect_equal_to_brute_force({{0, 0, 0}, {0, 0, 0}, {0.1, 0, 0}}, {});
}

TEST(BatchVoting, OfNothingIsNothing) {
  EXPECT_TRUE(vote_cloud({}, {}).tensors.empty());
  EXPECT_THROW((void)vote_cloud({}, {.sigma = 0}), std::invalid_argument);
  EXPECT_THROW((void)vote_cloud({}, {.radius = 0}), std::invalid_argument);
  EXPECT_THROW((void)vote_cloud({}, {.sigma = 0.3, .voxel = 0.001}), std::invalid_argument);
}

TEST(BatchVoting, SkipsAndCountsWhatIsNoPoint) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  const std::vector<Eigen::Vector3d> points{{0, 0, 0}, {kNaN, 0, 0}, {0.1, 0, 0}, {0, kInf, 0}, {0, 0, 1e300}};
  const CloudVotes votes = vote_cloud(points, {.voxel = 0});
  EXPECT_EQ(votes.not_finite, 2U);
  EXPECT_EQ(votes.too_far, 1U);
  EXPECT_GT(votes.tensors[0].mass, 0.8);
  EXPECT_EQ(votes.tensors[0].mass, votes.tensors[2].mass);
  for (const std::size_t i : {1U, 3U, 4U}) EXPECT_EQ(votes.tensors[i].mass, 0);
}

TEST(BatchVoting, AtAMillionMetresLosesNothing) {
  const auto near = test_clouds::street(2'000, 3);
  std::vector<Eigen::Vector3d> far;
  for (const auto& p : near) far.emplace_back(p + Eigen::Vector3d(1e6, -1e6, 1e3));
  const auto a = vote_cloud(near, {.voxel = 0});
  const auto b = vote_cloud(far, {.voxel = 0});
  for (std::size_t i = 0; i < near.size(); ++i) {
    EXPECT_LE((test_clouds::matrix(a.tensors[i]) - test_clouds::matrix(b.tensors[i])).norm(),
              1e-4 * test_clouds::matrix(a.tensors[i]).norm() + 3e-4);
  }
}

TEST(BatchVoting, TurnsWithTheCloud) {
  const auto points = test_clouds::street(2'000, 4);
  const Eigen::Matrix3d Q = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, -2, 1).normalized()).toRotationMatrix();
  std::vector<Eigen::Vector3d> turned;
  for (const auto& p : points) turned.emplace_back(Q * p);
  const auto a = vote_cloud(points, {.voxel = 0});
  const auto b = vote_cloud(turned, {.voxel = 0});
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Matrix3d expected = Q * test_clouds::matrix(a.tensors[i]) * Q.transpose();
    EXPECT_LE((test_clouds::matrix(b.tensors[i]) - expected).norm(), 1e-4 * expected.norm() + 3e-4);
  }
}

TEST(BatchVoting, GrowsWithTheCloud) {
  auto points = test_clouds::street(2'000, 5);
  const auto a = vote_cloud(points, {.voxel = 0});
  for (auto& p : points) p *= 2;
  const auto b = vote_cloud(points, {.sigma = 0.6, .radius = 1.8, .voxel = 0});
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_LE(test_clouds::relative_difference(b.tensors[i], a.tensors[i]), 1e-5);
}

TEST(BatchVoting, DoesNotMindTheOrderOfThePoints) {
  auto points = test_clouds::street(5'000, 6);
  const auto a = vote_cloud(points, {.voxel = 0});
  std::reverse(points.begin(), points.end());
  const auto b = vote_cloud(points, {.voxel = 0});
  for (std::size_t i = 0; i < points.size(); ++i) {
    // Close pairs: their direction is that of a difference of floats.
    EXPECT_LE(test_clouds::relative_difference(b.tensors[points.size() - 1 - i], a.tensors[i]), 3e-5);
  }
}

TEST(BatchVoting, HasTheSameBitsForAnyNumberOfThreads) {
  const auto points = test_clouds::street(20'000, 7);
  const BatchOptions everything{.second_pass = true, .equalise_density = true};
  for (const double voxel : {0.0, 0.1}) {
    const auto one = vote_cloud(points, {.voxel = voxel}, 1, everything);
    for (const int threads : {2, 3, 7}) {
      const auto many = vote_cloud(points, {.voxel = voxel}, threads, everything);
      EXPECT_EQ(std::memcmp(one.tensors.data(), many.tensors.data(), one.tensors.size() * sizeof(kernels::TensorF)), 0);
    }
  }
}

TEST(BatchVoting, KeepsItsMemoryAndNothingElse) {
  BatchVoter voter;
  CloudVotes votes;
  auto with_nonsense = test_clouds::street(2'000, 10);
  with_nonsense[7].x() = std::numeric_limits<double>::quiet_NaN();
  for (const auto& [points, voxel] : {std::pair{test_clouds::street(6'000, 8), 0.1}, std::pair{with_nonsense, 0.0},
                                      std::pair{test_clouds::street(4'000, 9), 0.0}}) {
    voter.vote(points, {.voxel = voxel}, 2, {}, votes);
    const auto expected = vote_cloud(points, {.voxel = voxel});
    EXPECT_EQ(votes.num_voters, expected.num_voters);
    EXPECT_EQ(votes.not_finite, expected.not_finite);
    ASSERT_EQ(votes.tensors.size(), points.size());
    ASSERT_EQ(votes.decompositions.size(), points.size());
    EXPECT_EQ(std::memcmp(votes.tensors.data(), expected.tensors.data(), points.size() * sizeof(kernels::TensorF)), 0);
  }
}

TEST(BatchVoting, IsTheSameOnEveryInstructionSetThatTheMachineHas) {
  const auto points = test_clouds::street(3'000, 11);
  const auto expected = vote_cloud(points, {.voxel = 0}, 1, {.kernel = "baseline"});
  for (const kernels::BatchKernel& kernel : kernels::batch_kernels()) {
    const auto votes = vote_cloud(points, {.voxel = 0}, 1, {.kernel = kernel.name});
    for (std::size_t i = 0; i < points.size(); ++i)
      EXPECT_LE(test_clouds::relative_difference(votes.tensors[i], expected.tensors[i]), 1e-5) << kernel.name;
  }
  EXPECT_THROW((void)vote_cloud(points, {}, 1, {.kernel = "abacus"}), std::invalid_argument);
}

TEST(BatchVoting, TakesEveryTensorApart) {
  const auto points = test_clouds::street(5'000, 8);
  const auto votes = vote_cloud(points, {.voxel = 0}, 2);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const kernels::TensorF& t = votes.tensors[i];
    const kernels::Decomposition d = kernels::decompose(kernels::Tensor{t.xx, t.xy, t.xz, t.yy, t.yz, t.zz, t.mass});
    EXPECT_NEAR(votes.decompositions[i].stick, d.stick, 2e-6);
    EXPECT_NEAR(votes.decompositions[i].plate, d.plate, 2e-6);
    EXPECT_EQ(votes.decompositions[i].mass, t.mass);
  }
}

TEST(BatchVoting, WithDensityEqualisedSeesTheRoadUnderScanLines) {
  // Lines 0.3 m apart (D = sigma), points 3 cm apart along them: bare, this looks like a curb on a flat road.
  std::vector<Eigen::Vector3d> rings;
  for (int line = -10; line <= 10; ++line) {
    for (int i = -100; i <= 100; ++i) rings.emplace_back(0.3 * line, 0.03 * i, 0);
  }
  const std::size_t middle = 10 * 201 + 100;
  const auto bare = vote_cloud(rings, {.voxel = 0});
  EXPECT_NEAR(bare.decompositions[middle].plate, 0.311, 0.02) << "the reference's table, D / sigma = 1";
  // A curb of nothing but density: a flat road, one line of it hit twelve times as often.
  std::vector<Eigen::Vector3d> uneven;
  for (int x = -40; x <= 40; ++x) {
    for (int y = -40; y <= 40; ++y) {
      const int copies = x == 0 ? 12 : 1;
      for (int k = 0; k < copies; ++k) uneven.emplace_back(0.075 * x, 0.075 * y + 0.005 * k, 0);
    }
  }
  std::size_t on_line = 0;
  while ((uneven[on_line] - Eigen::Vector3d(0, 0, 0)).norm() > 1e-9) ++on_line;
  const auto raw = vote_cloud(uneven, {.voxel = 0});
  const auto equal = vote_cloud(uneven, {.voxel = 0}, 1, {.equalise_density = true});
  EXPECT_GT(raw.decompositions[on_line].plate, 0.25F);
  EXPECT_LT(equal.decompositions[on_line].plate, 0.15F);
}

TEST(BatchVoting, ThinsAHeapByItselfAndSaysSo) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(0, 0.25);
  std::vector<Eigen::Vector3d> heap(1'000'000);
  for (auto& p : heap) p = {unit(random), unit(random), unit(random)};
  const auto votes = vote_cloud(heap, {.voxel = 0}, 2);
  EXPECT_DOUBLE_EQ(votes.voxel, 0.3 / 8);
  EXPECT_LT(votes.num_voters, 600U);
  EXPECT_GT(votes.tensors[999'999].mass, 0);
  EXPECT_EQ(vote_cloud(test_clouds::street(100, 1), {.voxel = 0}).voxel, 0) << "not where there is no need";
}

TEST(BatchVoting, ThinningBoundsTheTimeOfAHeap) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0.001, 0.099);
  std::vector<Eigen::Vector3d> heap(200'000);
  for (auto& p : heap) p = {unit(random), unit(random), unit(random)};
  const auto votes = vote_cloud(heap, {});
  EXPECT_LE(votes.tensors[0].mass, 27) << "at most the voxels around";
}

}  // namespace
}  // namespace curbstone::tensor_voting::voting
