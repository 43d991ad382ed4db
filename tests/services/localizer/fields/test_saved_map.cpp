#include "services/localizer/fields/saved_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "tests/services/localizer/yard.hpp"

namespace curbstone::localizer::fields {
namespace {

using test_yard::map_of;
using test_yard::Yard;

TEST(SavedMap, HasNoJumpAtTheBordersOfTiles) {
  SavedMap map(map_of(Yard{}));
  for (double along = -5; along < 5; along += 0.5) {
    const auto before = map.ground_at(3.0 - 1e-9, along), after = map.ground_at(3.0 + 1e-9, along);
    if (!before || !after) continue;
    EXPECT_NEAR(before->height, after->height, 1e-6) << along;
  }
}

TEST(SavedMap, KnowsTheSlopeThatItsHeightsHave) {
  SavedMap map(map_of(Yard{.turned = 0}));
  const auto at = [&](double y) { return map.ground_at(1.0, y); };
  double steepest = 0;
  for (double y = -3.3; y < -2.7; y += 0.01) {
    const auto low = at(y - 1e-4), here = at(y), high = at(y + 1e-4);
    ASSERT_TRUE(low && here && high);
    const double difference = (high->height - low->height) / 2e-4;
    const bool between_middles = std::abs(high->slope.y() - low->slope.y()) < 1e-6;
    if (between_middles) {
      EXPECT_NEAR(here->slope.y(), difference, 1e-3) << y;
    }
    steepest = std::max(steepest, -here->slope.y());
  }
  EXPECT_GT(steepest, 0.5) << "the curb: 0.1 m from cell to cell";
}

TEST(SavedMap, KnowsWhereACurbIsNear) {
  SavedMap map(map_of(Yard{.turned = 0}));
  for (const double x : {-4.0, 0.1, 2.9, 3.1}) {  // of several tiles
    const auto curb = map.ground_at(x, -3.0), beside = map.ground_at(x, -2.6), far = map.ground_at(x, -1.5);
    ASSERT_TRUE(curb && beside && far);
    EXPECT_TRUE(curb->by_curb && beside->by_curb) << x;
    EXPECT_FALSE(far->by_curb) << x;
  }
}

TEST(SavedMap, KeepsWhatIsAboutTheVehicleAndSaysTheSameAsOneThatKeepsAll) {
  const auto yard = map_of(Yard{});
  std::vector<TileKey> keys;
  for (int copy = 0; copy < 200; ++copy) {
    for (const auto& tile : yard) keys.push_back({tile.key.x + 10 * copy, tile.key.y});
  }
  int reads = 0;
  const auto source = [&](TileKey key) -> std::optional<semantic_map::tile::MapTile> {
    ++reads;
    for (int copy = std::max(0, key.x / 10 - 1); copy < 200; ++copy) {
      for (auto tile : yard) {
        tile.key.x += 10 * copy;
        if (tile.key == key) return tile;
      }
    }
    return std::nullopt;
  };
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  SavedMap map(keys, source);
  SavedMap one(yard);
  const int at_the_start = std::exchange(reads, 0);
  EXPECT_EQ(at_the_start, static_cast<int>(keys.size()));
  std::size_t most = 0;
  for (int copy = 0; copy < 200; ++copy) {
    for (double y = -8; y < 8; y += 0.5) {
      for (double x = -8; x < 8; x += 1) {  // where one copy has it as the yard has
        const auto here = map.ground_at(x + 30.0 * copy, y), there = one.ground_at(x, y);
        ASSERT_EQ(here.has_value(), there.has_value()) << copy << ": " << x << ", " << y;
        if (here) {
          ASSERT_NEAR(here->height, there->height, 1e-6);
        }
      }
    }
    most = std::max(most, map.kept());
  }
  EXPECT_LE(most, SavedMap::kMaxKept);
  EXPECT_GT(reads, static_cast<int>(SavedMap::kMaxKept)) << "so that it had to make room";
  EXPECT_EQ(map.unreadable(), 0U);
}

TEST(SavedMap, GoesOnWithoutATileThatIsGone) {
  const auto yard = map_of(Yard{});
  std::vector<TileKey> keys;
  for (const auto& tile : yard) keys.push_back(tile.key);
  bool is_gone = false;
  SavedMap map(keys, [&](TileKey key) -> std::optional<semantic_map::tile::MapTile> {
    for (const auto& tile : yard) {
      if (tile.key == key && !(is_gone && key == TileKey{0, 0})) return tile;
    }
    return std::nullopt;
  });
  is_gone = true;
  for (int again = 0; again < 3; ++again) {
    EXPECT_FALSE(map.ground_at(1.5, 1.5));
    EXPECT_TRUE(map.ground_at(-1.5, 1.5));
  }
  EXPECT_EQ(map.unreadable(), 1U) << "asked for once, while it is in the window";
}

TEST(SavedMap, SaysNothingWhereItHasNothing) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  SavedMap map(map_of(Yard{}));
  for (const double far : {1e4, 1e300, kNaN}) {
    EXPECT_FALSE(map.ground_at(far, 0)) << far;
    EXPECT_FALSE(map.upright_at(0, far)) << far;
    EXPECT_TRUE(std::isnan(map.level_at(far, far))) << far;
  }
}

}  // namespace
}  // namespace curbstone::localizer::fields
