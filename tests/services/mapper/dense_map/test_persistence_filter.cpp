#include "services/mapper/dense_map/persistence_filter.hpp"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <vector>

#include "tests/stamps.hpp"

namespace curbstone::mapper::dense_map {
namespace {

using test::kSecond;
const Eigen::Vector3d kSpot(10.1, -3.1, 0.9);

TEST(PersistenceFilter, StayAfterASecondWithoutABreak) {
  PersistenceFilter places(kSecond);
  for (int i = 0; i < 10; ++i) places.add_hit(kSpot, i * kSecond / 10);
  EXPECT_FALSE(places.is_static(kSpot));
  places.add_hit(kSpot, kSecond);
  EXPECT_TRUE(places.is_static(kSpot));
  EXPECT_FALSE(places.is_static(kSpot + Eigen::Vector3d(0.3, 0, 0)));
}

TEST(PersistenceFilter, ABreakBeginsAnew) {
  PersistenceFilter places(kSecond);
  places.add_hit(kSpot, 0);
  places.add_hit(kSpot, 3 * kSecond);  // another car
  EXPECT_FALSE(places.is_static(kSpot));
}

TEST(PersistenceFilter, WhatPassesIsSeenFromBelowAndBeside) {
  PersistenceFilter places(kSecond);
  places.add_hit(kSpot, 0);
  const Eigen::Vector3d under = kSpot - Eigen::Vector3d(0, 0, 0.8);
  for (const Eigen::Vector3d& beside :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.2, 0, 0), Eigen::Vector3d(-0.2, 0, 0), Eigen::Vector3d(0, 0.2, 0),
        Eigen::Vector3d(0, -0.2, 0)}) {
    EXPECT_TRUE(places.moving_above(under + beside, 0));
  }
  EXPECT_FALSE(places.moving_above(under + Eigen::Vector3d(0.6, 0, 0), 0));
  EXPECT_FALSE(places.moving_above(kSpot - Eigen::Vector3d(0, 0, 3), 0));
  places.add_hit(kSpot, kSecond);
  EXPECT_FALSE(places.moving_above(under, kSecond));  // it stays: no harm
}

TEST(PersistenceFilter, WhatPassesCloseAboveCountsToo) {
  PersistenceFilter places(kSecond);
  const Eigen::Vector3d bumper(10.1, -3.1, 0.5);
  places.add_hit(bumper, 0);
  EXPECT_TRUE(places.moving_above(bumper - Eigen::Vector3d(0, 0, 0.3), 0));  // its lower half
}

TEST(PersistenceFilter, WhatHasPassedIsNoLongerAbove) {
  PersistenceFilter places(kSecond);
  places.add_hit(kSpot, 0);
  const Eigen::Vector3d under = kSpot - Eigen::Vector3d(0, 0, 0.8);
  EXPECT_TRUE(places.moving_above(under, kSecond));
  EXPECT_FALSE(places.moving_above(under, kSecond + 1));
}

TEST(PersistenceFilter, OldOnesAreForgotten) {
  PersistenceFilter places(kSecond);
  places.add_hit(kSpot, 0);
  places.add_hit(-kSpot, 0);
  places.add_hit(-kSpot, kSecond);
  places.forget_before(kSecond / 2);
  EXPECT_EQ(places.size(), 1U);
  EXPECT_TRUE(places.is_static(-kSpot));
  EXPECT_FALSE(places.is_static(kSpot));
  places.clear();
  EXPECT_FALSE(places.is_static(-kSpot));
}

TEST(PersistenceFilter, PointsTogetherAreThePointsOneByOne) {
  PersistenceFilter together(kSecond), single(kSecond);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> along(-1, 1), up(0, 3);
  const auto points = [&] {
    std::vector<Eigen::Vector3d> all(400);
    for (Eigen::Vector3d& point : all) point = {along(random), along(random), up(random)};
    return all;
  };
  std::int64_t utime = 0;
  for (; utime < 3 * kSecond; utime += kSecond / 2) {
    const std::vector<Eigen::Vector3d> hits = points();
    together.add_hits(hits, utime);
    for (const Eigen::Vector3d& hit : hits) single.add_hit(hit, utime);
  }
  ASSERT_EQ(together.size(), single.size());
  std::array<PersistenceFilter::Suspect, PersistenceFilter::kTogether> suspects;
  std::array<bool, PersistenceFilter::kTogether> may{};
  int number = 0, moving = 0;
  for (int round = 0; round < 20; ++round) {
    const std::vector<Eigen::Vector3d> at = points();
    for (std::size_t i = 0; i < suspects.size(); ++i) suspects[i] = {at[i], utime, ++number % 2 == 0};
    together.may_move(suspects, may);
    for (std::size_t i = 0; i < suspects.size(); ++i) {
      ASSERT_EQ(may[i], suspects[i].is_high ? !single.is_static(at[i]) : single.moving_above(at[i], utime));
      moving += may[i] ? 1 : 0;
    }
  }
  EXPECT_GT(moving, number / 10);
  EXPECT_LT(moving, number * 9 / 10);
}

}  // namespace
}  // namespace curbstone::mapper::dense_map
