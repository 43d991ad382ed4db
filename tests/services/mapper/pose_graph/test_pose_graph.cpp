#include "services/mapper/pose_graph/pose_graph.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <random>

#include "services/mapper/registration/normal_equations.hpp"

namespace curbstone::mapper::pose_graph {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

registration::Matrix6 information(double sigma_m, double sigma_rad) {
  registration::Vector6 d;
  d << Eigen::Vector3d::Constant(1 / (sigma_m * sigma_m)), Eigen::Vector3d::Constant(1 / (sigma_rad * sigma_rad));
  return d.asDiagonal();
}

double distance(const Pose& a, const Pose& b) {
  return registration::log_of(a.inverse() * b).norm();
}

bool same_bits(const Pose& a, const Pose& b) {
  return std::memcmp(a.matrix().data(), b.matrix().data(), sizeof(double) * 16) == 0;
}

/// A drive of `laps` round a hilly circle of 40 m radius, a node every metre, from which loops may be measured.
struct Drive {
  std::vector<Pose> truth, poses;
  std::vector<bool> fixed;
  std::vector<PoseEdge> edges;

  explicit Drive(int nodes, double noise = 1, unsigned seed = 1) {
    std::mt19937 random(seed);
    std::normal_distribution<double> gauss;
    for (int i = 0; i < nodes; ++i) {
      const double a = i / 40.0;
      Pose T = Pose::Identity();
      T.translation() = Eigen::Vector3d(40 * std::cos(a), 40 * std::sin(a), 2 * std::sin(3 * a));
      T.linear() = so3_exp({0.05 * std::sin(2 * a), 0.1 * std::cos(3 * a), a}).toRotationMatrix();
      truth.push_back(T);
      if (i == 0) {
        poses.push_back(T);
        continue;
      }
      registration::Vector6 error;
      for (int k = 0; k < 6; ++k) error[k] = noise * (k < 3 ? 0.02 : 0.003) * gauss(random);
      const PoseEdge edge{i - 1, i, truth[static_cast<std::size_t>(i) - 1].inverse() * T * registration::exp_of(error),
                          information(0.02, 0.003)};
      poses.push_back(poses.back() * edge.T_from_to);
      edges.push_back(edge);
    }
    fixed.assign(poses.size(), false);
    fixed[0] = true;
  }
  void close(int from, int to, const Pose& error = Pose::Identity()) {
    edges.push_back({from, to, truth[std::size_t(from)].inverse() * truth[std::size_t(to)] * error,
                     information(0.02, 0.002), true});
  }
  [[nodiscard]] PoseGraphResult solve() const { return optimise_pose_graph(poses, fixed, edges); }
  [[nodiscard]] double worst(const std::vector<Pose>& result) const {
    double most = 0;
    for (std::size_t i = 0; i < result.size(); ++i)
      most = std::max(most, (result[i].translation() - truth[i].translation()).norm());
    return most;
  }
};

Pose shifted(double x, double y, double yaw) {
  return Pose(Eigen::Translation3d(x, y, 0) * Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()));
}

TEST(PoseGraph, FindsThePosesThatSatisfyEveryEdge) {
  Drive drive(300, 0);
  drive.close(0, 251);
  drive.close(20, 271);
  const std::vector<Pose> drifted = Drive(300, 1).poses;
  drive.poses = drifted;
  EXPECT_GT(drive.worst(drifted), 1.0);
  const PoseGraphResult result = drive.solve();
  ASSERT_TRUE(result.converged);
  for (std::size_t i = 0; i < drive.truth.size(); ++i) EXPECT_LT(distance(result.poses[i], drive.truth[i]), 1e-6);
  EXPECT_LT(result.chi2_after, 1e-6);
  EXPECT_EQ(result.edge_sigma.size(), drive.edges.size());
}

TEST(PoseGraph, SharesAKnownDriftOutAsTheWeightsSay) {
  // N edges along a line, each 1 % long, weight w; a loop of weight W says how long they truly are together. Each is
  // to be shortened by x that minimises N w x^2 + W (D - N x)^2.
  constexpr int kEdges = 100;
  std::vector<Pose> poses(1, Pose::Identity());
  std::vector<PoseEdge> edges;
  for (int i = 0; i < kEdges; ++i) {
    edges.push_back({i, i + 1, shifted(1.01, 0, 0), information(0.1, 0.01)});
    poses.push_back(poses.back() * edges.back().T_from_to);
  }
  edges.push_back({0, kEdges, shifted(kEdges, 0, 0), information(0.01, 0.01), true});
  std::vector<bool> fixed(poses.size(), false);
  fixed[0] = true;
  const PoseGraphResult result = optimise_pose_graph(poses, fixed, edges);
  ASSERT_TRUE(result.converged);
  const double x = 1e4 * 1.0 / (1e2 + kEdges * 1e4);
  for (int i = 0; i <= kEdges; ++i)
    EXPECT_NEAR(result.poses[static_cast<std::size_t>(i)].translation().x(), i * (1.01 - x), 1e-6);
}

TEST(PoseGraph, BringsANoisyDriveBackWithItsLoops) {
  Drive drive(1000);
  for (const int i : {10, 100, 200}) drive.close(i, i + 251);
  for (const int i : {50, 240}) drive.close(i, i + 3 * 251);
  const PoseGraphResult result = drive.solve();
  ASSERT_TRUE(result.converged);
  EXPECT_GT(drive.worst(drive.poses), 5.0);
  EXPECT_LT(drive.worst(result.poses), 0.3 * drive.worst(drive.poses));
  EXPECT_LT((result.poses[993].translation() - result.poses[240].translation()).norm(),
            0.1 + (drive.truth[993].translation() - drive.truth[240].translation()).norm());
  EXPECT_LT(result.chi2_after, result.chi2_before);
}

TEST(PoseGraph, AFalseLoopAmongGoodOnesIsOutvoted) {
  const auto close = [](Drive& drive) {
    for (const int i : {10, 100, 200}) drive.close(i, i + 251);
    for (const int i : {50, 240}) drive.close(i, i + 3 * 251);
  };
  Drive good(1000);
  close(good);
  const PoseGraphResult without = good.solve();
  // farther off than a drive of this noise could be: 65 nodes from the next good one
  for (const Pose& error : {shifted(12, -5, 0.5), shifted(-4, 2, 0.1), shifted(0, 0, 0.3)}) {
    Drive drive(1000);
    close(drive);
    drive.close(75, 75 + 251, error);
    const PoseGraphResult with = drive.solve();
    ASSERT_TRUE(with.converged);
    EXPECT_GT(with.edge_sigma.back(), 15);
    EXPECT_LT(*std::max_element(with.edge_sigma.end() - 6, with.edge_sigma.end() - 1), 4);
    double most = 0;
    for (std::size_t i = 0; i < with.poses.size(); ++i)
      most = std::max(most, (with.poses[i].translation() - without.poses[i].translation()).norm());
    EXPECT_LT(most, 0.02);
  }
}

TEST(PoseGraph, AFalseLoopThatAgreesWithTheDriftIsOutvotedToo) {
  // Where a search begins at the drifted poses, this one is believed and the good ones are not.
  Drive drive(1000);
  for (const int i : {240, 220, 200}) drive.close(i, i + 3 * 251);
  drive.edges.push_back(
      {230, 230 + 753, drive.poses[230].inverse() * drive.poses[230 + 753], information(0.02, 0.002), true});
  const PoseGraphResult result = drive.solve();
  ASSERT_TRUE(result.converged);
  EXPECT_GT(result.edge_sigma.back(), 15);
  EXPECT_LT(result.edge_sigma[result.edge_sigma.size() - 2], 4);
}

TEST(PoseGraph, FixedNodesKeepTheirBits) {
  Drive drive(600);
  for (std::size_t i = 100; i < 200; ++i) drive.fixed[i] = true;
  drive.close(150, 401);
  drive.close(170, 421);
  const PoseGraphResult result = drive.solve();
  ASSERT_TRUE(result.converged);
  for (std::size_t i = 0; i < 600; ++i)
    EXPECT_EQ(same_bits(result.poses[i], drive.poses[i]), i == 0 || (i >= 100 && i < 200)) << i;
}

TEST(PoseGraph, NodesThatNothingJoinsStayWhereTheyAre) {
  Drive drive(300);
  drive.close(10, 261);
  drive.poses.push_back(shifted(1e4, -3, 1));
  drive.truth.push_back(drive.poses.back());
  drive.fixed.push_back(false);
  const PoseGraphResult result = drive.solve();
  ASSERT_TRUE(result.converged);
  EXPECT_TRUE(same_bits(result.poses.back(), drive.poses.back()));
}

TEST(PoseGraph, TheSameInputGivesTheSameBitsAndAnyOrderTheSamePoses) {
  Drive drive(600, 1, 7);
  for (const int i : {10, 100, 300}) drive.close(i, i + 251);
  const PoseGraphResult first = drive.solve();
  const std::vector<double> elsewhere(12345);  // so that memory is laid out otherwise
  const PoseGraphResult second = drive.solve();
  ASSERT_TRUE(first.converged);
  for (std::size_t i = 0; i < first.poses.size(); ++i) EXPECT_TRUE(same_bits(first.poses[i], second.poses[i]));
  EXPECT_EQ(first.edge_sigma, second.edge_sigma);

  std::shuffle(drive.edges.begin(), drive.edges.end(), std::mt19937(3));
  const PoseGraphResult shuffled = drive.solve();
  for (std::size_t i = 0; i < first.poses.size(); ++i) EXPECT_LT(distance(first.poses[i], shuffled.poses[i]), 1e-5);
}

TEST(PoseGraph, LivesWithDirectionsThatAnEdgeSaysNothingAbout) {
  Drive drive(100, 0);
  drive.edges[50].information(0, 0) = 0;  // a tunnel: not how far along
  drive.close(10, 90);                    // but the loop tells
  drive.poses = Drive(100, 1).poses;
  const PoseGraphResult result = drive.solve();
  ASSERT_TRUE(result.converged);
  EXPECT_LT(drive.worst(result.poses), 1e-4);
}

TEST(PoseGraph, WithoutLoopsThereIsNothingToDo) {
  EXPECT_TRUE(Drive(300).solve().converged) << "nor where all agree already";
  const PoseGraphResult nothing = optimise_pose_graph({}, {}, {});
  EXPECT_TRUE(nothing.converged);
  const PoseGraphResult lone = optimise_pose_graph({shifted(1, 2, 3)}, {false}, {});
  EXPECT_TRUE(lone.converged);
  EXPECT_TRUE(same_bits(lone.poses[0], shifted(1, 2, 3)));
}

TEST(PoseGraph, RefusesWhatCannotBeSolvedAndGivesThePosesBack) {
  const Drive good(50);
  ASSERT_TRUE(good.solve().converged);
  const auto refused = [](const Drive& drive) {
    const PoseGraphResult result = drive.solve();
    if (result.converged || result.poses.size() != drive.poses.size()) return false;
    for (std::size_t i = 0; i < result.poses.size(); ++i) {
      if (!same_bits(result.poses[i], drive.poses[i])) return false;
    }
    return true;
  };
  Drive drive = good;
  drive.edges[3].to = 50;
  EXPECT_TRUE(refused(drive)) << "no such node";
  drive = good;
  drive.edges[3].from = -1;
  EXPECT_TRUE(refused(drive)) << "no such node";
  drive = good;
  drive.edges[3].to = drive.edges[3].from;
  EXPECT_TRUE(refused(drive)) << "to itself";
  drive = good;
  drive.fixed.pop_back();
  EXPECT_TRUE(refused(drive)) << "sizes";
  drive = good;
  drive.fixed[0] = false;
  EXPECT_TRUE(refused(drive)) << "nothing is fixed";
  drive = good;
  drive.edges.erase(drive.edges.begin() + 20);
  EXPECT_TRUE(refused(drive)) << "what comes after the gap hangs on nothing";
  drive = good;
  drive.poses[9].translation().x() = kNaN;
  EXPECT_TRUE(refused(drive)) << "NaN pose";
  drive = good;
  drive.edges[9].T_from_to.linear()(1, 1) = kNaN;
  EXPECT_TRUE(refused(drive)) << "NaN edge";
  drive = good;
  drive.edges[9].information(2, 2) = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(refused(drive)) << "infinite information";
  drive = good;
  drive.edges[9].information(2, 2) = -1;
  EXPECT_TRUE(refused(drive)) << "negative information";
  drive = good;
  drive.edges[9].information(2, 3) = 1e5;
  EXPECT_TRUE(refused(drive)) << "not symmetric";
  drive = good;
  drive.edges[9].T_from_to.translation().x() = 1e200;
  EXPECT_TRUE(refused(drive)) << "overflows";
}

}  // namespace
}  // namespace curbstone::mapper::pose_graph
