#include "services/mapper/place_recognition/branch_and_bound.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace curbstone::mapper::place_recognition {
namespace {

using Cloud = std::vector<Eigen::Vector3f>;

/// Walls of a few rooms.
Cloud rooms() {
  Cloud out;
  const auto wall = [&](float x0, float y0, float x1, float y1) {
    for (float f = 0; f <= 1; f += 0.01F) out.push_back({x0 + f * (x1 - x0), y0 + f * (y1 - y0), 1});
  };
  wall(-12, -8, 14, -8), wall(14, -8, 14, 9), wall(14, 9, -5, 9), wall(-5, 9, -5, 3), wall(-12, 3, -5, 3);
  wall(-12, 3, -12, -8), wall(2, -8, 2, -3), wall(6, 2, 10, 2);
  return out;
}

Cloud seen_from(const Cloud& points, double x, double y, double yaw) {
  const Eigen::Isometry3f T =
      (Eigen::Translation3d(x, y, 0) * Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ())).inverse().cast<float>();
  Cloud out;
  for (const Eigen::Vector3f& p : points) out.push_back(T * p);
  return out;
}

TEST(PrecomputationGrids, ALevelBoundsAllThatIsUnderIt) {
  const PrecomputationGrids map(rooms(), 20);
  const auto value = [&](int level, int x, int y) { return map.level(level)[std::size_t(y * map.side() + x)]; };
  std::mt19937 random(1);
  std::uniform_int_distribution<int> place(0, map.side() - 1);
  for (int level = 1; level < PrecomputationGrids::kLevels; ++level) {
    for (int i = 0; i < 300; ++i) {
      const int x0 = place(random), y0 = place(random);
      int most = 0;
      for (int y = y0; y < std::min(y0 + (1 << level), map.side()); ++y) {
        for (int x = x0; x < std::min(x0 + (1 << level), map.side()); ++x) most = std::max<int>(most, value(0, x, y));
      }
      EXPECT_EQ(value(level, x0, y0), most);
    }
  }
}

TEST(PrecomputationGrids, IsOneOnAWallAndNothingFarFromIt) {
  const PrecomputationGrids map(rooms(), 20);
  EXPECT_DOUBLE_EQ(map.at({14, 0, 1}), 1);
  EXPECT_GT(map.at({13.8F, 0, 1}), 0.5);
  EXPECT_DOUBLE_EQ(map.at({11, -3, 1}), 0);
  EXPECT_DOUBLE_EQ(map.at({1e9F, 0, 0}), 0);
  EXPECT_DOUBLE_EQ(map.at({NAN, 0, 0}), 0);
}

TEST(SearchPlane, FindsWhereAScanWasTaken) {
  for (const double reach : {2.0, 5.0, 15.0}) {
    const PrecomputationGrids map(rooms(), lattice_reach(reach));
    for (const double yaw : {0.0, 0.13, -3.0}) {
      const double x = 0.83 * reach, y = -0.4 * reach;
      const auto found = branch_and_bound(map, seen_from(rooms(), x, y, yaw), {reach, yaw > -1 ? 0 : 3.1, 0.2}, 3);
      ASSERT_FALSE(found.empty());
      EXPECT_NEAR(found[0].x, x, 0.21);
      EXPECT_NEAR(found[0].y, y, 0.21);
      EXPECT_NEAR(std::remainder(found[0].yaw - yaw, 2 * std::numbers::pi), 0, 0.011);
      EXPECT_GT(found[0].score, 0.7);
    }
  }
}

TEST(SearchPlane, GivesTheTrueMaximumOfTheLattice) {
  constexpr double kReach = 3;
  const PrecomputationGrids map(rooms(), lattice_reach(kReach));
  Cloud scan;  // few points, so that the surface has many hills
  for (const std::size_t i : {5U, 120U, 260U, 333U, 470U, 610U, 700U, 790U}) scan.push_back(rooms()[i]);
  const auto found = branch_and_bound(map, scan, {kReach, 0.05, 0}, 5);
  ASSERT_FALSE(found.empty());
  double most = 0;
  const Cloud turned = seen_from(scan, 0, 0, -0.05);
  for (int y = -15; y <= 15; ++y) {
    for (int x = -15; x <= 15; ++x) {
      int sum = 0;
      for (const Eigen::Vector3f& p : turned) {
        const int cell = (map.cell(double(p.y())) + y) * map.side() + map.cell(double(p.x())) + x;
        sum += map.level(0)[std::size_t(cell)];
      }
      most = std::max(most, sum / (255.0 * double(scan.size())));
    }
  }
  EXPECT_NEAR(found[0].score, most, 0.02);  // a point on the edge of a cell may fall on its other side
  for (std::size_t i = 1; i < found.size(); ++i) {
    EXPECT_LE(found[i].score, found[i - 1].score);
    EXPECT_GE(std::hypot(found[i].x - found[0].x, found[i].y - found[0].y), 1.4) << "another place";
  }
}

TEST(SearchPlane, TellsAllTurnsOfASquareRoomApart) {
  Cloud square;
  for (float f = -6; f <= 6; f += 0.1F) {
    square.insert(square.end(), {{f, 6, 1}, {f, -6, 1}, {6, f, 1}, {-6, f, 1}});
  }
  const PrecomputationGrids map(square, lattice_reach(2));
  const auto found = branch_and_bound(map, seen_from(square, 0.5, 0.5, 0.2), {2, 0, std::numbers::pi}, 8);
  ASSERT_EQ(found.size(), 4U) << "what is far behind them is none";
  for (const PlanarPose& pose : found) EXPECT_GT(pose.score, 0.85);
}

TEST(SearchPlane, OfNothingFindsNothing) {
  const PrecomputationGrids map(rooms(), lattice_reach(5));
  EXPECT_TRUE(branch_and_bound(map, {}, {5, 0, 0.1}, 3).empty());
  EXPECT_TRUE(branch_and_bound(map, {{NAN, 1, 1}, {1e9F, 0, 0}}, {5, 0, 0.1}, 3).empty());
  EXPECT_TRUE(branch_and_bound(map, rooms(), {20, 0, 0.1}, 3).empty()) << "the lattice ends before the range does";
  EXPECT_TRUE(branch_and_bound(map, rooms(), {5, 0, NAN}, 3).empty());
  EXPECT_TRUE(branch_and_bound(map, rooms(), {5, 0, 0.1}, 0).empty());
}

}  // namespace
}  // namespace curbstone::mapper::place_recognition
