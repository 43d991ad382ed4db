#include "services/semantic_map/tile/driven_path.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace curbstone::semantic_map::tile {
namespace {

/// A drive of 200 m that stands, turns back on itself and crosses its own way.
std::vector<Eigen::Vector2d> wandering_drive(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<> turn(-0.3, 0.3);
  std::vector<Eigen::Vector2d> places = {{0, 0}};
  double heading = 0;
  for (int i = 0; i < 2000; ++i) {
    if (i % 50 == 7) places.push_back(places.back());
    heading += turn(random);
    places.push_back(places.back() + 0.1 * Eigen::Vector2d(std::cos(heading), std::sin(heading)));
  }
  return places;
}

Eigen::Vector2d nearest_of_all(const std::vector<Eigen::Vector2d>& places, const Eigen::Vector2d& at) {
  return *std::min_element(places.begin(), places.end(),
                           [&](const auto& a, const auto& b) { return (a - at).norm() < (b - at).norm(); });
}

std::optional<Eigen::Vector2d> direction_of_all(const std::vector<Eigen::Vector2d>& places, const Eigen::Vector2d& at,
                                                double within) {
  std::optional<Eigen::Vector2d> direction;
  for (std::size_t i = 1; i < places.size(); ++i) {
    const double distance = (places[i] - at).norm();
    if (distance >= within || places[i] == places[i - 1]) continue;
    within = distance;
    direction = (places[i] - places[i - 1]).normalized();
  }
  return direction;
}

TEST(DrivenPath, FindsWhatASearchOfTheWholeFinds) {
  std::mt19937 random(5);
  std::uniform_real_distribution<> coordinate(-60, 60);
  const auto places = wandering_drive(1);
  const DrivenPath path(places);
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector2d at(coordinate(random), coordinate(random));
    EXPECT_EQ(path.nearest(at), nearest_of_all(places, at));
    for (const double within : {0.5, 8.0, 20.0})
      EXPECT_EQ(path.direction_near(at, within), direction_of_all(places, at, within)) << within;
  }
}

TEST(DrivenPath, OfPlacesEquallyFarTheEarliestCounts) {
  const DrivenPath path{{0, 1}, {1, 0}, {0, -1}, {-1, 0}};
  EXPECT_EQ(path.nearest({0, 0}), Eigen::Vector2d(0, 1));
  EXPECT_EQ(path.direction_near({0, 0}, 2), Eigen::Vector2d(1, -1).normalized()) << "nobody drove to the first place";
}

TEST(DrivenPath, FindsItFromFarAwayToo) {
  const DrivenPath path{{0, 0}, {1, 0}};
  EXPECT_EQ(path.nearest({1e4, 3}), Eigen::Vector2d(1, 0));
  EXPECT_EQ(path.nearest({-1e300, 0}), Eigen::Vector2d(0, 0));
  EXPECT_EQ(path.direction_near({1e300, 0}, 8), std::nullopt);
}

TEST(DrivenPath, APlaceThatIsHeardOfLateHasItsTurn) {
  DrivenPath path;
  path.add(10, {0, 0});
  path.add(30, {2, 0});
  path.add(20, {1, 1});
  path.add(20, {9, 9});
  EXPECT_EQ(path.places(), (std::vector<Eigen::Vector2d>{{0, 0}, {1, 1}, {2, 0}}));
  EXPECT_EQ(path.last(), Eigen::Vector2d(2, 0));
  EXPECT_EQ(path.direction_near({2, 0}, 0.5), Eigen::Vector2d(1, -1).normalized());
}

TEST(DrivenPath, AnEmptyOneHasNothing) {
  DrivenPath path{{1, 2}};
  path.clear();
  EXPECT_TRUE(path.empty());
  EXPECT_EQ(path.nearest({0, 0}), std::nullopt);
  EXPECT_EQ(path.direction_near({0, 0}, 10), std::nullopt);
}

}  // namespace
}  // namespace curbstone::semantic_map::tile
