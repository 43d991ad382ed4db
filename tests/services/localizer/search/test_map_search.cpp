#include "services/localizer/search/map_search.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "services/localizer/search/local_scan.hpp"
#include "tests/services/localizer/yard.hpp"

namespace curbstone::localizer::search {
namespace {

using test_yard::map_of;
using test_yard::points_in;
using test_yard::pose_at;
using test_yard::Yard;

std::vector<Eigen::Vector2d> plan_from(const Yard& yard, const Pose& T_map_base) {
  LocalScan scan;
  scan.add(points_in(yard, T_map_base), Pose::Identity());
  return scan.plan(Pose::Identity(), SearchRegion::kSight, MapSearch::kMaxPlaces);
}

std::vector<Candidate> candidates_of(MapSearch& search, std::int64_t piece) {
  while (search.advance(piece)) {
  }
  return search.candidates();
}

TEST(SearchRegion, EachLevelBoundsTheOneBelow) {
  const fields::SavedMap map(map_of(Yard{}));
  const SearchRegion region({0, 0}, map);
  for (int level = 1; level < SearchRegion::kLevels; ++level) {
    const int half = 1 << (level - 1);
    for (int y = 0; y < 60; y += 7) {
      for (int x = 0; x < 60; ++x) {
        int most = 0;
        for (const int v : {y, y + half}) {
          for (const int u : {x, x + half}) most = std::max(most, int{*region.upright(level - 1, u, v)});
        }
        ASSERT_EQ(*region.upright(level, x, y), most) << level << " " << x << " " << y;
      }
    }
  }
}

TEST(SearchRegion, AVehicleIsOnTheRoadOrJustBesideIt) {
  const fields::SavedMap map(map_of(Yard{.turned = 0}));
  const SearchRegion region({0, 0}, map);
  const auto drivable = [&](double x, double y) {
    return region.drivable(0, static_cast<int>(x / SearchRegion::kCell), static_cast<int>(y / SearchRegion::kCell));
  };
  EXPECT_TRUE(drivable(5, 5));
  EXPECT_TRUE(drivable(5, 7.2));
  EXPECT_FALSE(drivable(5, 8.5));
  EXPECT_FALSE(drivable(13, 2));
}

TEST(SearchRegion, CoversThePlaneWithoutGaps) {
  EXPECT_EQ(SearchRegion::region_of({0, 63}), (TileKey{0, 0}));
  EXPECT_EQ(SearchRegion::region_of({-1, 64}), (TileKey{-1, 1}));
  EXPECT_EQ(SearchRegion::region_of({-64, -65}), (TileKey{-1, -2}));
}

TEST(MapSearch, FindsAVehicleThatLooksAnyWay) {
  const Yard yard;
  const fields::SavedMap map(map_of(yard));
  for (const double yaw : {0.2, 1.9, -2.4}) {
    MapSearch search(plan_from(yard, pose_at(-3, 1, yaw)), map);
    const auto found = candidates_of(search, 1'000'000);
    ASSERT_FALSE(found.empty()) << yaw;
    EXPECT_LT(std::hypot(found[0].x + 3, found[0].y - 1), 0.4) << yaw;
    EXPECT_LT(std::abs(std::remainder(found[0].yaw - yaw, 2 * M_PI)), 0.03) << yaw;
    EXPECT_GT(found[0].score, 0.7) << yaw;
  }
}

TEST(MapSearch, FindsTheSameInPiecesOfAnySize) {
  const Yard yard;
  const fields::SavedMap map(map_of(yard));
  const auto plan = plan_from(yard, pose_at(2, 0, 0.7));
  MapSearch at_once(plan, map), in_pieces(plan, map);
  const auto all = candidates_of(at_once, std::int64_t{1} << 60), pieces = candidates_of(in_pieces, 1000);
  ASSERT_EQ(all.size(), pieces.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].x, pieces[i].x);
    EXPECT_EQ(all[i].yaw, pieces[i].yaw);
    EXPECT_EQ(all[i].score, pieces[i].score);
  }
  EXPECT_EQ(at_once.lookups(), in_pieces.lookups());
}

TEST(MapSearch, DoesALittleOfTheWorkAtATime) {
  const fields::SavedMap map(map_of(Yard{}));
  MapSearch search(plan_from(Yard{}, Pose::Identity()), map);
  ASSERT_TRUE(search.advance(20'000'000));
  EXPECT_LT(search.lookups(), 20'000'000 + 11'000'000) << "a region's lattices may be the last piece";
}

TEST(MapSearch, FindsBothOfTwoPlacesThatAreAlike) {
  const Yard yard;
  fields::SavedMap map(test_yard::twice(map_of(yard), 40));  // 120 m on
  MapSearch search(plan_from(yard, pose_at(-3, 1, 0.2)), map);
  const auto found = candidates_of(search, 1'000'000);
  ASSERT_GE(found.size(), 2U);
  EXPECT_NEAR(std::abs(found[0].x - found[1].x), 120, 0.5);
  EXPECT_NEAR(found[0].score, found[1].score, 0.1);
}

TEST(MapSearch, SaysNothingWhereNothingIsLikeIt) {
  const fields::SavedMap map(map_of(Yard{}));
  MapSearch nothing_seen({}, map);
  EXPECT_TRUE(candidates_of(nothing_seen, 1000).empty());
  std::vector<Eigen::Vector2d> spokes;
  for (int i = 0; i < 120; ++i) spokes.emplace_back(Eigen::Rotation2Dd(0.9 * (i % 7)) * Eigen::Vector2d(0.24 * i, 0));
  MapSearch strange(spokes, map);
  EXPECT_TRUE(candidates_of(strange, 1'000'000).empty());
}

}  // namespace
}  // namespace curbstone::localizer::search
