// Towns of several blocks, and the ways through them.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>

#include "common/config/vehicle.hpp"
#include "tools/simulate/motion/town_motion.hpp"
#include "tools/simulate/motion/town_route.hpp"
#include "tools/simulate/world/town.hpp"

namespace curbstone::simulate::world {
namespace {

class Blocks : public testing::TestWithParam<int> {
 protected:
  static const world::Town& town() {
    static std::map<int, world::Town> towns;
    const int seed = GetParam();
    const auto it = towns.find(seed);
    return it != towns.end()
               ? it->second
               : towns.emplace(seed, world::TownOptions{.seed = static_cast<std::uint64_t>(seed), .loop = 1000})
                     .first->second;
  }
};
INSTANTIATE_TEST_SUITE_P(Seeds, Blocks, testing::Range(1, 4));

TEST_P(Blocks, AreAsLongRoundAsWanted) {
  EXPECT_NEAR(town().streets.front().length(), 1000, 2);
  EXPECT_NEAR(motion::TownRoute::around(town()).length(), 1000, 15) << "the lane is on the outside of bends";
}

TEST_P(Blocks, StreetsOfTheLoopAreFarFromEachOther) {
  const motion::TownRoute route = motion::TownRoute::around(town());
  const int n = route.size();
  for (int i = 0; i < n; ++i) {
    for (int j = i + 200; j < n && j - i < n - 200; ++j)
      ASSERT_GT((route.at(i) - route.at(j)).norm(), 80.0) << i << " and " << j;
  }
}

TEST_P(Blocks, HaveOtherStreetsThanTheLoopAndPartsThatAreNotAlike) {
  EXPECT_GE(town().streets.size(), 6U);
  double lowest = 1e9, highest = 0;
  for (const world::Shape& shape : town().scene->shapes()) {
    if (shape.surface != world::Surface::kWall) continue;
    lowest = std::min(lowest, static_cast<double>(shape.half.x()));
    highest = std::max(highest, static_cast<double>(shape.half.x()));
  }
  EXPECT_LT(2 * lowest, 9) << "a terrace";
  EXPECT_GT(2 * highest, 15) << "a block of flats";
}

void expect_free(const world::Town& town, const motion::TownRoute& route) {
  const VehicleConfig vehicle;
  for (int i = 0; i < route.size(); ++i) {
    const Eigen::Vector2d step = route.at(i + 1) - route.at(i);
    ASSERT_GT(step.norm(), 0.4) << i;
    ASSERT_LT(step.norm(), 1.6) << i;
    const Eigen::Vector2d before = route.at(i) - route.at(i - 1);
    ASSERT_GT(before.normalized().dot(step.normalized()), std::cos(0.2)) << "no kinks, at " << i;
    const Eigen::Vector2d left = Eigen::Vector2d(-step.y(), step.x()).normalized();
    for (const double off : {-0.5, 0.0, 0.5}) {
      const Eigen::Vector2d p = route.at(i) + off * vehicle.width * left;
      const auto x = static_cast<float>(p.x()), y = static_cast<float>(p.y());
      EXPECT_LT(town.scene->ground().at(x, y).distance, -1.0F) << "on the carriageway, at " << i;
      for (const auto& shape : town.scene->shapes()) {
        const bool hangs_over =
            shape.bottom() > town.scene->ground().height_at(x, y) + static_cast<float>(vehicle.height);
        EXPECT_TRUE(hangs_over || !shape.covers(x, y, 0.2F)) << "at " << i;
      }
    }
  }
}

TEST_P(Blocks, LeaveTheVehiclesWayFree) {
  expect_free(town(), motion::TownRoute::around(town()));
  expect_free(town(), motion::TownRoute::there_and_back(town()));
}

TEST_P(Blocks, ThereAndBackComesHomeTheOtherWay) {
  const motion::TownRoute route = motion::TownRoute::there_and_back(town());
  EXPECT_FALSE(route.closed());
  EXPECT_NEAR(route.length(), 1200, 30);
  const int n = route.size();
  EXPECT_LT((route.at(n - 1) - route.at(0)).norm(), 4.0) << "in the other lane";
  const Eigen::Vector2d out = route.at(60) - route.at(0), home = route.at(n - 1) - route.at(n - 61);
  EXPECT_LT(out.normalized().dot(home.normalized()), -0.99);
}

TEST_P(Blocks, TheDriveStandsWhereItsWayEnds) {
  const motion::TownRoute route = motion::TownRoute::there_and_back(town());
  motion::SpeedProfile::Options options;
  options.distance = route.length() - 4.0;
  const motion::TownMotion motion(town(), {}, motion::SpeedProfile(options, std::numeric_limits<double>::infinity()),
                                  route);
  const double end = motion.profile().end();
  EXPECT_GT(end, 400);
  EXPECT_NEAR(motion.profile().distance(end), options.distance, 1e-6);
  EXPECT_EQ(motion.profile().distance(end + 100), motion.profile().distance(end + 1));
  EXPECT_LT((motion.T_world_base(end).translation().head<2>() - route.at(route.size() - 1)).norm(), 5.0);
}

}  // namespace
}  // namespace curbstone::simulate::world
