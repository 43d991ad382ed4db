// Stick and plate votes of decomposed tensors, formula (G): against its own integral, exact lattices and brute force.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>
#include <random>

#include "services/tensor_voting/kernels/batch_kernel.hpp"
#include "services/tensor_voting/voting/ball_vote.hpp"
#include "services/tensor_voting/voting/batch_voting.hpp"
#include "services/tensor_voting/voting/oriented_vote.hpp"
#include "services/tensor_voting/voting/step_cloud.hpp"
#include "tests/services/tensor_voting/clouds.hpp"

namespace curbstone::tensor_voting::voting {
namespace {

using test_clouds::matrix;
using test_clouds::street;

Eigen::Vector3d random_direction(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
}

TEST(ProjectorVote, IsTheMeanOfTheStickVotesInItsSpan) {
  std::mt19937 random(1);
  const double sigma = 0.3;
  for (int rank = 1; rank <= 3; ++rank) {
    const Eigen::Matrix3d axes =
        Eigen::Quaterniond(Eigen::AngleAxisd(1.1, random_direction(random))).toRotationMatrix();
    const Eigen::Vector3d d = 0.2 * random_direction(random);
    const Eigen::Matrix3d Q = axes.leftCols(rank) * axes.leftCols(rank).transpose();
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    constexpr int kDraws = 400'000;
    std::normal_distribution<double> normal;
    for (int i = 0; i < kDraws; ++i) {
      Eigen::Vector3d n = Eigen::Vector3d::Zero();
      for (int k = 0; k < rank; ++k) n += normal(random) * axes.col(k);
      n.normalize();
      const Eigen::Vector3d u = d.normalized();
      const Eigen::Vector3d turned = n - 2 * u.dot(n) * u;
      sum += std::exp(-d.squaredNorm() / (sigma * sigma)) * (1 - u.dot(n) * u.dot(n)) * turned * turned.transpose();
    }
    const Eigen::Matrix3d expected = projector_vote(d, Q, rank, sigma) / rank;
    EXPECT_LE((sum / kDraws - expected).norm(), 5e-3 * expected.norm()) << "rank " << rank;
  }
}

TEST(ProjectorVote, OfABallIsTheExactCosineSquaredField) {
  const Eigen::Vector3d d(0.1, -0.2, 0.05);
  kernels::Tensor ball;
  add_ball_vote(d, {.sigma = 0.3, .radius = 0.9, .ball = 0.5}, ball);
  EXPECT_LE((projector_vote(d, Eigen::Matrix3d::Identity(), 3, 0.3) - 0.8 * test_clouds::matrix(ball)).norm(), 1e-15);
}

TEST(SecondPass, OfAPlaneIsAllStickAndOfALineAllPlate) {
  std::vector<Eigen::Vector3d> plane;
  for (int x = -48; x <= 48; ++x) {
    for (int y = -48; y <= 48; ++y) plane.emplace_back(0.1 * x, 0.1 * y, 0);
  }
  const CloudVotes flat = vote_cloud(plane, {.radius = 2.4, .voxel = 0}, 2, {.second_pass = true});
  // Far from the edge every voter's normal is z and its stick share 1/2: T = W/2 z z^T.
  const double w = std::numbers::pi * 0.09 / 0.01 - 1;
  const std::size_t middle = 48 * 97 + 48;
  EXPECT_LE(
      (test_clouds::matrix(flat.tensors[middle]) - Eigen::Vector3d(0, 0, w / 2).asDiagonal().toDenseMatrix()).norm(),
      1e-5 * w);
  EXPECT_NEAR(flat.decompositions[middle].stick, 1, 1e-5);
  EXPECT_NEAR(flat.decompositions[middle].mass, w / 2, 1e-5 * w);

  std::vector<Eigen::Vector3d> line;
  for (int x = -60; x <= 60; ++x) line.emplace_back(0.1 * x, 0, 0);
  const CloudVotes thin = vote_cloud(line, {.radius = 2.4, .voxel = 0}, 1, {.second_pass = true});
  const double l = std::sqrt(std::numbers::pi) * 0.3 / 0.1 - 1;
  EXPECT_LE((test_clouds::matrix(thin.tensors[60]) - Eigen::Vector3d(0, l, l).asDiagonal().toDenseMatrix()).norm(),
            1e-5 * l);
  EXPECT_NEAR(thin.decompositions[60].plate, 1, 1e-5);
}

TEST(SecondPass, EqualsTheDoubleBruteForce) {
  for (const VotingParameters& p :
       {VotingParameters{.voxel = 0}, VotingParameters{.sigma = 0.5, .radius = 2.5, .voxel = 0}}) {
    const auto points = test_clouds::street(2'000, 7);
    const CloudVotes first = vote_cloud(points, p, 2);
    const CloudVotes second = vote_cloud(points, p, 2, {.second_pass = true});
    std::vector<kernels::Decomposition> voters;
    for (const kernels::DecompositionF& d : first.decompositions) {
      voters.push_back({d.normal.cast<double>(), d.tangent.cast<double>(), d.stick, d.plate, d.ball, d.mass});
    }
    const auto expected = vote_again_brute_force(points, voters, p);
    for (std::size_t i = 0; i < points.size(); ++i) {
      // A pair at the very cut-off may be rounded to either side of it.
      const double at_cut_off = 2 * std::exp(-p.radius * p.radius / (p.sigma * p.sigma));
      EXPECT_LE((test_clouds::matrix(second.tensors[i]) - test_clouds::matrix(expected[i])).norm(),
                2e-5 * test_clouds::matrix(expected[i]).norm() + at_cut_off);
      EXPECT_NEAR(second.tensors[i].mass, expected[i].mass, 2e-5 * expected[i].mass + at_cut_off);
    }
  }
}

TEST(SecondPass, SharpensTheStreet) {
  const auto points = test_clouds::street(60'000, 8);
  const CloudVotes first = vote_cloud(points, {.sigma = 0.3, .voxel = 0}, 2);
  const CloudVotes second = vote_cloud(points, {.sigma = 0.3, .voxel = 0}, 2, {.second_pass = true});
  double road_before = 0;
  double road_after = 0;
  int road = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (std::abs(points[i].y()) > 2.5 || std::abs(points[i].x()) > 9) continue;
    road_before += double{first.decompositions[i].stick};
    road_after += double{second.decompositions[i].stick};
    ++road;
  }
  EXPECT_LT(road_before / road, 0.5);
  EXPECT_GT(road_after / road, 0.85);
}

TEST(BatchKernels, AgreeOnBallsPlatesAndSticks) {
  // One block of votees and all voters in one run, on every instruction set that this machine has.
  std::mt19937 random(3);
  std::uniform_int_distribution<std::int32_t> offset(-(3 << 20), 3 << 20);
  constexpr std::uint32_t kVoters = 3001;
  std::vector<std::int32_t> x(kVoters + kernels::kReadAhead), y(x.size()), z(x.size());
  std::vector<kernels::OrientedVoter> oriented(kVoters);
  std::vector<float> weight(kVoters);
  for (std::uint32_t i = 0; i < kVoters; ++i) {
    x[i] = offset(random), y[i] = offset(random) / 2, z[i] = offset(random) / 8;
    if (i < kernels::kBlock) x[i] /= 8, y[i] /= 8;  // the votees lie together
    const Eigen::Vector3f n = random_direction(random).cast<float>();
    const Eigen::Vector3f t = random_direction(random).cast<float>();
    oriented[i] = {{n.x(), n.y(), n.z()}, 0.6F, {t.x(), t.y(), t.z()}, 0.3F};
    weight[i] = 0.1F + 0.001F * static_cast<float>(i % 900);
  }
  const kernels::VoterRun runs[] = {{0, 17}, {17, 1000}, {1017, kVoters - 1017}};
  for (const bool weighted : {false, true}) {
    const kernels::VoterArrays voters{x.data(), y.data(), z.data(), weighted ? weight.data() : nullptr,
                                      oriented.data()};
    for (const kernels::BatchScale scale : {kernels::BatchScale{1, 3}, kernels::BatchScale{4, 6}}) {
      for (const auto vote :
           {&kernels::BatchKernel::ball, &kernels::BatchKernel::oriented, &kernels::BatchKernel::count}) {
        const int components = vote == &kernels::BatchKernel::ball       ? 6
                               : vote == &kernels::BatchKernel::oriented ? 7
                                                                         : 1;
        kernels::BlockVotes expected;
        (kernels::batch_kernels().back().*vote)(voters, runs, 3, 0, 7, scale, expected.sum);
        for (const kernels::BatchKernel& kernel : kernels::batch_kernels()) {
          kernels::BlockVotes votes;
          (kernel.*vote)(voters, runs, 3, 0, 7, scale, votes.sum);
          for (int lane = 0; lane < 7; ++lane) {
            for (int c = 0; c < components; ++c) {
              const int i = c * kernels::kBlock + lane;
              EXPECT_NEAR(votes.sum[i], expected.sum[i], 1e-5F * expected.sum[lane]) << kernel.name << " " << i;
            }
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace curbstone::tensor_voting::voting
