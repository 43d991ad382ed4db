#include "services/tensor_voting/batch_voting.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>
#include <numbers>
#include <random>

#include "services/tensor_voting/ball_vote.hpp"
#include "tests/services/tensor_voting/clouds.hpp"

namespace curbstone {
namespace {

using testing_clouds::matrix;
using testing_clouds::relative_difference;

/// On the same whole steps: a pair at the cut-off must not fall on either side of it by chance.
void expect_equal_to_brute_force(const std::vector<Eigen::Vector3d>& points, VotingParameters parameters) {
  parameters.voxel = 0;
  const StepCloud cloud = to_steps(points, parameters.sigma);
  std::vector<Eigen::Vector3d> in_steps;
  for (const StepPoint& p : cloud.points) in_steps.emplace_back(p.x, p.y, p.z);
  VotingParameters scaled = parameters;
  scaled.sigma /= cloud.step;
  scaled.radius /= cloud.step;
  const auto expected = vote_brute_force(in_steps, scaled);
  const auto votes = vote_cloud(points, parameters, 2);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_LE((matrix(votes.tensors[i]) - matrix(expected[i])).norm(), 1e-5 * matrix(expected[i]).norm() + 4e-9) << i;
  }
}

TEST(BatchVoting, OfAPlaneLatticeIsExact) {
  std::vector<Eigen::Vector3d> points;
  for (int x = -24; x <= 24; ++x) {
    for (int y = -24; y <= 24; ++y) points.emplace_back(0.1 * x, 0.1 * y, 0);
  }
  const CloudVotes votes = vote_cloud(points, {.radius = 2.4, .voxel = 0});
  const Tensor& t = votes.tensors[24 * 49 + 24];
  const double w = std::numbers::pi * 0.09 / 0.01 - 1;
  EXPECT_NEAR(t.mass, w, 1e-5 * w);
  EXPECT_LE((matrix(t) - w * Eigen::Vector3d(0.5, 0.5, 1).asDiagonal().toDenseMatrix()).norm(), 1e-5 * w);
}

TEST(BatchVoting, EqualsBruteForceOnStreetRandomAndDegenerateClouds) {
  expect_equal_to_brute_force(testing_clouds::street(3'000, 1), {});
  expect_equal_to_brute_force(testing_clouds::street(3'000, 2), {.sigma = 0.1, .radius = 0.3, .ball = 0.5});
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
  EXPECT_THROW((void)vote_batch({}, 0.002, {.radius = 0}), std::invalid_argument);
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
  const auto near = testing_clouds::street(2'000, 3);
  std::vector<Eigen::Vector3d> far;
  for (const auto& p : near) far.emplace_back(p + Eigen::Vector3d(1e6, -1e6, 1e3));
  const auto a = vote_cloud(near, {.voxel = 0});
  const auto b = vote_cloud(far, {.voxel = 0});
  for (std::size_t i = 0; i < near.size(); ++i) {
    EXPECT_LE((matrix(a.tensors[i]) - matrix(b.tensors[i])).norm(), 1e-4 * matrix(a.tensors[i]).norm() + 3e-4);
  }
}

TEST(BatchVoting, TurnsWithTheCloud) {
  const auto points = testing_clouds::street(2'000, 4);
  const Eigen::Matrix3d Q = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, -2, 1).normalized()).toRotationMatrix();
  std::vector<Eigen::Vector3d> turned;
  for (const auto& p : points) turned.emplace_back(Q * p);
  const auto a = vote_cloud(points, {.voxel = 0});
  const auto b = vote_cloud(turned, {.voxel = 0});
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Matrix3d expected = Q * matrix(a.tensors[i]) * Q.transpose();
    EXPECT_LE((matrix(b.tensors[i]) - expected).norm(), 1e-4 * expected.norm() + 3e-4);
  }
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
}  // namespace curbstone
