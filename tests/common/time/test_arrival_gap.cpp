#include "common/time/arrival_gap.hpp"

#include <gtest/gtest.h>

#include "tests/stamps.hpp"

namespace curbstone {
namespace {

using test::kStart;

/// Samples each 10 ms for `seconds`, whose stamps lie `behind` us before their arrivals; each fifth is 30 ms later.
std::int64_t feed(ArrivalGap& gap, std::int64_t from, int seconds, std::int64_t behind) {
  for (int i = 0; i < seconds * 100; ++i)
    gap.add(from + i * 10'000 - behind, from + i * 10'000 + (i % 5 == 0 ? 30'000 : 0));
  return from + seconds * 1'000'000;
}

TEST(ArrivalGap, IsThatOfTheLeastDelayedSampleOfASecond) {
  ArrivalGap gap;
  EXPECT_FALSE(gap.difference());
  feed(gap, kStart, 3, 1500);
  ASSERT_TRUE(gap.difference());
  EXPECT_EQ(*gap.difference(), -1500);
  EXPECT_FALSE(gap.fault());
}

TEST(ArrivalGap, StampsOfAClockThatTheHostNoLongerHasAreAFaultUntilTheyFollow) {
  ArrivalGap gap;
  std::int64_t now = feed(gap, kStart, 3, 0);
  now = feed(gap, now + 60'000, 3, 60'000);  // the clock was set forward by 60 ms
  EXPECT_EQ(gap.difference(), -60'000);
  ASSERT_TRUE(gap.fault());
  EXPECT_TRUE(gap.fault()->starts_with("stamps lie 60 ms before")) << *gap.fault();
  feed(gap, now, 3, 0);
  EXPECT_FALSE(gap.fault());
}

TEST(ArrivalGap, AnArrivalBeforeTheLastOneBeginsAnew) {
  ArrivalGap gap;
  feed(gap, kStart, 3, 0);
  feed(gap, kStart - 3'600'000'000, 3, 70'000);
  EXPECT_EQ(gap.difference(), -70'000);
}

}  // namespace
}  // namespace curbstone
