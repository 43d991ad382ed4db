#include "services/mapper/registration/plane_matches.hpp"

#include <gtest/gtest.h>

#include <random>

namespace curbstone::mapper::registration {
namespace {

struct Match {
  Eigen::Vector3d p, n;  // base_link when matched
  double distance, variance;
};

std::vector<Match> some_matches(int count) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::vector<Match> out;
  for (int i = 0; i < count; ++i) {
    Match m;
    m.p = Eigen::Vector3d(20 * normal(random), 20 * normal(random), 2 * normal(random)).cast<float>().cast<double>();
    m.n = Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized().cast<float>().cast<double>();
    m.distance = 0.05 * normal(random);
    m.variance = 4e-4 + 1e-4 * std::abs(normal(random));
    out.push_back(m);
  }
  return out;
}

PlaneMatches held(const std::vector<Match>& matches) {
  PlaneMatches out;
  for (const Match& m : matches) out.add(m.p.cast<float>(), m.n.cast<float>(), m.distance, m.variance);
  return out;
}

/// The same equations, match by match.
NormalEquations one_by_one(const std::vector<Match>& matches, const Pose& moved, const RobustKernel& kernel) {
  NormalEquations sum;
  for (const Match& m : matches) {
    ++sum.found;
    const double r = m.distance + m.n.dot(moved * m.p - m.p);
    const double bound = std::max(kernel.bound, std::sqrt(m.variance));
    if (std::abs(r) >= kernel.reach) continue;
    if (std::abs(r) < 3 * bound) {
      ++sum.inliers;
      sum.squared_error += r * r;
    }
    sum.add(m.p, moved.linear().transpose() * m.n, r, std::min(1.0, bound / std::abs(r)) / m.variance);
  }
  return sum;
}

TEST(PlaneMatches, AddUpToWhatEachOfThemSays) {
  Vector6 d;
  d << 0.03, -0.02, 0.01, 0.002, -0.001, 0.01;
  const RobustKernel kernel{0.2, 0.03};
  for (const int count : {0, 1, 3, 4, 5, 255, 256, 257, 1000}) {
    const std::vector<Match> matches = some_matches(count);
    for (const Pose& moved : {Pose(Pose::Identity()), exp_of(d)}) {
      const NormalEquations fast = held(matches).at(moved, kernel);
      const NormalEquations slow = one_by_one(matches, moved, kernel);
      EXPECT_EQ(fast.found, count);
      EXPECT_NEAR(fast.inliers, slow.inliers, 1);  // one may stand on the bound
      EXPECT_LE((fast.H - slow.H).norm(), 1e-5 * slow.H.norm());
      EXPECT_LE((fast.b - slow.b).norm(), 1e-5 * slow.H.norm() * 0.05);
      EXPECT_NEAR(fast.weight, slow.weight, 1e-5 * slow.weight);
      EXPECT_NEAR(fast.lever, slow.lever, 1e-5 * slow.lever);
      EXPECT_NEAR(fast.squared_error, slow.squared_error, 1e-3 * slow.squared_error);
    }
  }
}

TEST(PlaneMatches, OutOfReachDoesNotCount) {
  PlaneMatches matches;
  matches.add({1, 2, 3}, {0, 0, 1}, 0.5, 1e-4);
  const NormalEquations sum = matches.at(Pose::Identity(), {0.2, 0.03});
  EXPECT_EQ(sum.found, 1);
  EXPECT_EQ(sum.inliers, 0);
  EXPECT_EQ(sum.weight, 0);
  EXPECT_EQ(sum.H.norm(), 0);
}

}  // namespace
}  // namespace curbstone::mapper::registration
