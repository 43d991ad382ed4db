// The double reference against the exact lattice sums and the closed forms of the ball vote.
#include "services/tensor_voting/voting/ball_vote.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <numbers>

#include "tests/services/tensor_voting/clouds.hpp"

namespace curbstone::tensor_voting::voting {
namespace {

using test_clouds::matrix;
using test_clouds::relative_difference;
constexpr double kPi = std::numbers::pi;

/// The tensor at the origin of a lattice of spacing h; `keep` chooses its nodes.
template <class Keep>
kernels::Tensor lattice(double h, int n, const VotingParameters& parameters, Keep keep) {
  kernels::Tensor tensor;
  for (int x = -n; x <= n; ++x) {
    for (int y = -n; y <= n; ++y) {
      for (int z = -n; z <= n; ++z) {
        if (keep(x, y, z)) add_ball_vote(h * Eigen::Vector3d(x, y, z), parameters, tensor);
      }
    }
  }
  return tensor;
}

void expect_near(const kernels::Tensor& t, const Eigen::Matrix3d& expected, double relative) {
  EXPECT_LE((test_clouds::matrix(t) - expected).norm(), relative * expected.norm())
      << test_clouds::matrix(t) << "\nexpected\n"
      << expected;
}

class BallVote : public ::testing::TestWithParam<double> {
 protected:
  const double a = GetParam();
  const VotingParameters wide{.sigma = 0.3, .radius = 2.4, .ball = a, .voxel = 0};
  const double h = 0.1;
  const int n = 24;
  const double plane = kPi * 0.09 / (h * h) - 1;
  const double line = std::sqrt(kPi) * 0.3 / h - 1;
};
INSTANTIATE_TEST_SUITE_P(Coefficients, BallVote, ::testing::Values(1.0, 0.6, 0.5));

TEST_P(BallVote, OnAPlaneLatticeIsExact) {
  const kernels::Tensor t = lattice(h, n, wide, [](int, int, int z) { return z == 0; });
  EXPECT_NEAR(t.mass, 27.274333882308138, 1e-12 * t.mass);
  expect_near(t, plane * Eigen::Vector3d(1 - a / 2, 1 - a / 2, 1).asDiagonal().toDenseMatrix(), 1e-12);
}

TEST_P(BallVote, OnALineLatticeIsExact) {
  const kernels::Tensor t = lattice(h, n, wide, [](int, int y, int z) { return y == 0 && z == 0; });
  EXPECT_NEAR(t.mass, 4.317361552716547, 1e-12 * t.mass);
  expect_near(t, line * Eigen::Vector3d(1 - a, 1, 1).asDiagonal().toDenseMatrix(), 1e-12);
}

TEST_P(BallVote, InAVolumeLatticeIsExact) {
  const kernels::Tensor t = lattice(h, n, wide, [](int, int, int) { return true; });
  expect_near(t, (std::pow(std::sqrt(kPi) * 0.3 / h, 3) - 1) * (1 - a / 3) * Eigen::Matrix3d::Identity(), 1e-12);
}

TEST_P(BallVote, AtTheEdgeOfAHalfPlaneIsThePlaneAndTheLineHalved) {
  const kernels::Tensor t = lattice(h, n, wide, [](int, int y, int z) { return y >= 0 && z == 0; });
  const Eigen::Matrix3d expected =
      0.5 * (plane * Eigen::Vector3d(1 - a / 2, 1 - a / 2, 1) + line * Eigen::Vector3d(1 - a, 1, 1)).asDiagonal();
  expect_near(t, expected, 1e-12);
}

TEST_P(BallVote, AtARightCreaseIsHalfOfBothPlanes) {
  // Both half-planes own the edge; each of its nodes votes twice, as two halves of two planes do.
  kernels::Tensor t = lattice(h, n, wide, [](int, int y, int z) { return y > 0 && z == 0; });
  const auto add = [&t](const kernels::Tensor& other, double weight) {
    t.xx += weight * other.xx, t.yy += weight * other.yy, t.zz += weight * other.zz;
  };
  add(lattice(h, n, wide, [](int, int y, int z) { return y == 0 && z > 0; }), 1);
  add(lattice(h, n, wide, [](int, int y, int z) { return y == 0 && z == 0; }), 1);
  expect_near(t, plane * Eigen::Vector3d(1 - a / 2, 1 - a / 4, 1 - a / 4).asDiagonal().toDenseMatrix(), 1e-12);
}

TEST_P(BallVote, CutOffAtThreeSigmaLosesTheKnownMass) {
  VotingParameters cut = wide;
  cut.radius = 0.9;
  const kernels::Tensor dense_plane = lattice(0.01, 91, cut, [](int, int, int z) { return z == 0; });
  EXPECT_NEAR((dense_plane.mass + 1) / (kPi * 900), 1 - std::exp(-9.0), 2e-5);
}

TEST_P(BallVote, TraceIsMassTimesThreeMinusA) {
  const auto points = test_clouds::street(300, 5);
  for (const kernels::Tensor& t : vote_brute_force(points, {.ball = a})) {
    EXPECT_NEAR(test_clouds::matrix(t).trace(), (3 - a) * t.mass, 1e-12 * (1 + t.mass));
  }
}

TEST_P(BallVote, IsInvariantUnderMotionScaleAndOrder) {
  const auto points = test_clouds::street(300, 7);
  const VotingParameters parameters{.ball = a};
  const auto tensors = vote_brute_force(points, parameters);
  const Eigen::Matrix3d Q = Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  std::vector<Eigen::Vector3d> moved;
  for (const auto& p : points) moved.push_back(5 * (Q * p) + Eigen::Vector3d(10, -20, 3));
  std::reverse(moved.begin(), moved.end());
  VotingParameters scaled = parameters;
  scaled.sigma *= 5;
  scaled.radius *= 5;
  const auto again = vote_brute_force(moved, scaled);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Matrix3d expected = Q * test_clouds::matrix(tensors[i]) * Q.transpose();
    EXPECT_LE((test_clouds::matrix(again[points.size() - 1 - i]) - expected).norm(), 1e-10 * (1 + expected.norm()));
  }
}

TEST(BallVoteReference, StreetGivesTheSaliencyOfUnrelatedCodes) {
  // 10,000 points, sigma 0.3: sum of (l1 - l2) = 22779.8 for one draw; the spread over draws is below one per cent.
  const auto points = test_clouds::street(10'000, 1);
  double sum = 0;
  for (const kernels::Tensor& t : vote_brute_force(points, {})) {
    const Eigen::Vector3d l = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(test_clouds::matrix(t)).eigenvalues();
    sum += l[2] - l[1];
  }
  EXPECT_NEAR(sum, 22779.8, 0.02 * 22779.8);
}

TEST(BallVoteReference, DuplicatesAndLonelyPointsAreNotANumberNowhere) {
  const std::vector<Eigen::Vector3d> points{{0, 0, 0}, {0, 0, 0}, {100, 0, 0}};
  for (const kernels::Tensor& t : vote_brute_force(points, {})) EXPECT_EQ(t.mass, 0);
}

TEST(VotingParameters, ThatMeanNothingAreRefusedByName) {
  EXPECT_THROW(validate({.sigma = 0}), std::invalid_argument);
  EXPECT_THROW(validate({.sigma = -1}), std::invalid_argument);
  EXPECT_THROW(validate({.radius = 0}), std::invalid_argument);
  EXPECT_THROW(validate({.radius = std::nan("")}), std::invalid_argument);
  EXPECT_THROW(validate({.ball = 0.4}), std::invalid_argument);
  EXPECT_THROW(validate({.voxel = -0.1}), std::invalid_argument);
  EXPECT_NO_THROW(validate({}));
  try {
    validate({.sigma = 0});
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "sigma = 0.000000: expected a length > 0, in m");
  }
}

}  // namespace
}  // namespace curbstone::tensor_voting::voting
