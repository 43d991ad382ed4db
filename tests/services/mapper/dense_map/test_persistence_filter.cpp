#include "services/mapper/dense_map/persistence_filter.hpp"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace curbstone::mapper::dense_map
