// What runs on the GPU, piece by piece, on the CPU: cells and the ranges of their neighbours, the vote of a pair, the
// eigen-decomposition.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <random>

#include "services/tensor_voting/cuda/field_votes.hpp"
#include "services/tensor_voting/kernels/decomposition.hpp"
#include "services/tensor_voting/voting/ball_vote.hpp"
#include "services/tensor_voting/voting/oriented_vote.hpp"
#include "tests/services/tensor_voting/clouds.hpp"
#include "tests/services/tensor_voting/cuda/cuda_host_machine.hpp"

namespace curbstone::tensor_voting::cuda {
namespace {

using test_clouds::matrix;

TEST(CudaCellGrid, NoVoterWithinReachIsOutsideTheRanges) {
  std::mt19937 random(1);
  for (const double radius : {450.0, 150.0, 1.0, 7.3}) {
    const CellGrid grid = CellGrid::for_radius(radius, 1, 1);
    std::uniform_int_distribution<int> near(-static_cast<int>(4 * radius) - 3, static_cast<int>(4 * radius) + 3);
    for (int i = 0; i < 20'000; ++i) {
      const Eigen::Vector3i a(near(random), near(random), near(random));
      const Eigen::Vector3i b(near(random), near(random), near(random));
      const std::uint64_t first = grid.key(a.x(), a.y(), a.z());
      const std::uint64_t key = grid.key(b.x(), b.y(), b.z());
      int found = 0;
      for (int row = 0; row < CellGrid::kRows; ++row) {
        const CellGrid::KeyRange range = grid.voters_in_row(first, first, row);
        found += key >= range.low && key < range.high ? 1 : 0;
      }
      EXPECT_LE(found, 1) << "each voter once";
      if ((a - b).cast<double>().norm() < radius) {
        EXPECT_EQ(found, 1) << a.transpose() << " and " << b.transpose();
      }
    }
  }
}

TEST(CudaCellGrid, EndsWhereItsBitsEnd) {
  const CellGrid grid = CellGrid::for_radius(450, 1, 1);
  const std::int64_t last = std::int64_t{grid.edge_yz} * ((1 << 19) - 1) - 1;
  EXPECT_TRUE(grid.contains(0, last, last));
  EXPECT_FALSE(grid.contains(0, last + 1, 0));
  EXPECT_FALSE(grid.contains(0, 0, last + 1));
  EXPECT_LT(grid.key(0, last, last), CellGrid::kNoCell);
  const std::uint64_t corner = grid.key(0, last, last);
  for (int row = 0; row < CellGrid::kRows; ++row) {
    EXPECT_LE(grid.voters_in_row(corner, corner, row).high, CellGrid::kNoCell);
  }
  EXPECT_LT(grid.key(-1, 0, 0), grid.key(0, 0, 0));
  EXPECT_LT(grid.key(5000, -1, 0), grid.key(-5000, 0, 0));
}

TEST(CudaLowerBound, IsTheLibrarys) {
  const std::vector<std::uint64_t> keys{1, 3, 3, 3, 8};
  for (std::uint64_t key = 0; key < 10; ++key) {
    EXPECT_EQ(lower_bound(keys.data(), 0, 5, key),
              static_cast<std::uint32_t>(std::lower_bound(keys.begin(), keys.end(), key) - keys.begin()));
  }
  EXPECT_EQ(lower_bound(keys.data(), 0, 0, 1), 0U);
}

class CudaPair : public ::testing::TestWithParam<double> {
 protected:
  const voting::VotingParameters parameters{.sigma = 300, .radius = 900, .ball = GetParam(), .voxel = 0};  // in steps
};
INSTANTIATE_TEST_SUITE_P(Coefficients, CudaPair, ::testing::Values(1.0, 0.6, 0.5));

TEST_P(CudaPair, BallVoteIsTheReferences) {
  std::mt19937 random(3);
  std::uniform_int_distribution<int> step(-600, 600);
  for (int i = 0; i < 5'000; ++i) {
    const std::vector<kernels::StepPoint> points{{10, -20, 30},
                                                 {10 + step(random), -20 + step(random), 30 + step(random)}};
    BallVotes<false> votes;
    kernels::TensorF tensor;
    VotedShape shape;
    votes.points = points.data();
    votes.decay = {static_cast<float>(-std::numbers::log2e / (300.0 * 300.0)), 900.0F * 900.0F};
    votes.ball = static_cast<float>(GetParam());
    votes.tensors = &tensor;
    votes.shapes = &shape;
    BallVotes<false>::Sums sums;
    votes.add(votes.voter(1, points[0]), votes.votee(0, points[0]), sums);
    votes.store(0, sums);
    kernels::Tensor expected;
    const Eigen::Vector3d d(points[1].x - 10, points[1].y + 20, points[1].z - 30);
    voting::add_ball_vote(d, parameters, expected);
    EXPECT_LE((test_clouds::matrix(tensor) - test_clouds::matrix(expected)).norm(),
              2e-6 * test_clouds::matrix(expected).norm())
        << d.transpose();
    EXPECT_EQ(shape.mass, tensor.mass);
  }
}

TEST(CudaPair, OrientedVoteIsTheReferences) {
  std::mt19937 random(4);
  std::uniform_int_distribution<int> step(-600, 600);
  std::normal_distribution<double> normal;
  const voting::VotingParameters parameters{.sigma = 300, .radius = 900, .voxel = 0};
  for (int i = 0; i < 5'000; ++i) {
    const Eigen::Vector3i d(step(random), step(random), step(random));
    const Eigen::Matrix3d axes = Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
                                     .normalized()
                                     .toRotationMatrix();
    const kernels::Decomposition voter{axes.col(0), axes.col(2), 0.4, 0.3, 0.3, 7};
    VotedShape shape;
    for (int k = 0; k < 3; ++k) {
      shape.normal[k] = static_cast<float>(voter.normal[k]);
      shape.tangent[k] = static_cast<float>(voter.tangent[k]);
    }
    shape.stick = 0.4F;
    shape.plate = 0.3F;
    const std::vector<kernels::StepPoint> points{{d.x(), d.y(), d.z()}};
    OrientedVotes<false> votes;
    votes.points = points.data();
    votes.oriented = &shape;
    votes.decay = {static_cast<float>(-std::numbers::log2e / (300.0 * 300.0)), 900.0F * 900.0F};
    kernels::TensorF sums;
    votes.add(votes.voter(0, {0, 0, 0}), {0, 0, 0}, sums);
    kernels::Tensor expected;
    voting::add_oriented_vote(d.cast<double>(), voter, parameters, expected);
    EXPECT_LE((test_clouds::matrix(sums) - test_clouds::matrix(expected)).norm(), 5e-6 * expected.mass)
        << d.transpose();
    EXPECT_NEAR(sums.mass, expected.mass, 2e-6 * expected.mass);
  }
}

TEST(CudaPair, ExactVoteIsWithinAUnitOfTheReferences) {
  std::mt19937 random(5);
  std::uniform_int_distribution<int> step(-400, 400);
  const kernels::Decay decay = kernels::decay_in_steps(0.3, 0.9, kPositionStep);
  for (int i = 0; i < 5'000; ++i) {
    const Eigen::Vector3i d(step(random), step(random), step(random));
    const auto d2 = static_cast<float>(d.squaredNorm());
    if (!(d2 > 0 && d2 < decay.radius2)) continue;
    const LocalOffset offset{static_cast<float>(d.x()), static_cast<float>(d.y()), static_cast<float>(d.z())};
    const LocalOffset opposite{-offset.x, -offset.y, -offset.z};
    const ExactPair pair(decay, 1, offset, d2);
    const ExactPair back(decay, -1, opposite, d2);
    const double w = std::exp(-kPositionStep * kPositionStep / 0.09 * d.squaredNorm());
    EXPECT_NEAR(pair.component[kernels::VoteSums::kMass] * kernels::kVoteUnit, w, 1e-6 * w + kernels::kVoteUnit);
    EXPECT_NEAR(pair.component[kernels::VoteSums::kXY] * kernels::kVoteUnit, w * d.x() * d.y() / d.squaredNorm(),
                1e-6 * w + kernels::kVoteUnit);
    for (int c = 0; c < kernels::VoteSums::kCount; ++c) {
      EXPECT_EQ(pair.component[c], -back.component[c]) << "either end, and back again";
    }
  }
}

kernels::TensorF tensor_of(const Eigen::Matrix3d& m) {
  const auto at = [&](int i, int j) { return static_cast<float>(m(i, j)); };
  return {at(0, 0), at(0, 1), at(0, 2), at(1, 1), at(1, 2), at(2, 2), 1};
}
Eigen::Vector3d vector_of(const float* v) {
  return {v[0], v[1], v[2]};
}

TEST(CudaEigen, AgreesWithTheDecompositionInDouble) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 3'000; ++i) {
    Eigen::Matrix3d b;
    for (int k = 0; k < 9; ++k) b(k / 3, k % 3) = normal(random);
    const kernels::TensorF t = tensor_of(b * b.transpose() * std::pow(10.0, normal(random) * 4));
    const VotedShape s = shape_of(t);
    const kernels::Tensor wide{t.xx, t.xy, t.xz, t.yy, t.yz, t.zz, t.mass};
    const kernels::Decomposition d = kernels::decompose(wide);
    EXPECT_NEAR(s.stick, d.stick, 2e-6);
    EXPECT_NEAR(s.plate, d.plate, 2e-6);
    EXPECT_NEAR(s.ball, d.ball, 2e-6);
    const Eigen::Matrix3d m = test_clouds::matrix(wide) / test_clouds::matrix(wide).trace();
    const double l1 = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(m).eigenvalues()[2];
    const Eigen::Vector3d n = vector_of(s.normal);
    const Eigen::Vector3d e3 = vector_of(s.tangent);
    EXPECT_LE((m * n - l1 * n).norm(), 2e-6);
    EXPECT_LE((m * e3 - l1 * double{s.ball} * e3).norm(), 2e-6);
    EXPECT_NEAR(n.norm(), 1, 1e-6);
    EXPECT_NEAR(e3.norm(), 1, 1e-6);
    EXPECT_GE(n.z(), 0);
    EXPECT_GE(e3.z(), 0);
  }
}

TEST(CudaEigen, SignsAndEqualEigenvaluesFollowTheConvention) {
  const auto same = [](const kernels::TensorF& t) {
    const VotedShape s = shape_of(t);
    const kernels::Decomposition d = kernels::decompose(kernels::Tensor{t.xx, t.xy, t.xz, t.yy, t.yz, t.zz, t.mass});
    EXPECT_LE((vector_of(s.normal) - d.normal).norm(), 1e-6) << d.normal.transpose();
    EXPECT_LE((vector_of(s.tangent) - d.tangent).norm(), 1e-6) << d.tangent.transpose();
    EXPECT_NEAR(s.stick, d.stick, 1e-6);
    EXPECT_NEAR(s.plate, d.plate, 1e-6);
    EXPECT_NEAR(s.ball, d.ball, 1e-6);
    EXPECT_EQ(s.mass, static_cast<float>(d.mass));
  };
  same({.xx = 2, .yy = 2, .zz = 2, .mass = 1});
  same({.xx = 1, .yy = 1, .zz = 0.25F, .mass = 1});
  same({.xx = 0.5F, .yy = 0.5F, .zz = 1, .mass = 7});
  same({.xx = 0, .yy = 1, .zz = 1, .mass = 1});
  same({.xx = 0.5F, .yy = 0.75F, .zz = 0.75F, .mass = 1});
  same({.xx = 1});
  same({.yy = 1});
  same({.zz = 1});
  for (const Eigen::Vector3d& n : {Eigen::Vector3d(0.6, -0.8, 0), Eigen::Vector3d(-0.6, 0, -0.8)}) {
    EXPECT_LE((vector_of(shape_of(tensor_of(n * n.transpose())).normal) + n).norm(), 1e-6);
  }
}

TEST(CudaEigen, OfNothingHasNoShares) {
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInf = std::numeric_limits<float>::infinity();
  for (const kernels::TensorF& t : {kernels::TensorF{}, kernels::TensorF{.xx = kNaN},
                                    kernels::TensorF{.xx = 1, .xy = kNaN}, kernels::TensorF{.xx = kInf}}) {
    const VotedShape s = shape_of(t);
    EXPECT_EQ(s.stick + s.plate + s.ball + s.mass, 0);
    EXPECT_EQ(vector_of(s.normal), Eigen::Vector3d::UnitZ());
    EXPECT_EQ(vector_of(s.tangent), Eigen::Vector3d::UnitX());
  }
}

}  // namespace
}  // namespace curbstone::tensor_voting::cuda
