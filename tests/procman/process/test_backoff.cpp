#include "procman/process/backoff.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace curbstone::procman::process {
namespace {

TEST(Backoff, DoublesFrom20MillisecondsTo1SecondForACrasher) {
  Backoff backoff;
  std::vector<std::int64_t> gaps_ms;
  for (int i = 0; i < 8; ++i) gaps_ms.push_back(backoff.next(60'000) / 1000);
  EXPECT_EQ(gaps_ms, (std::vector<std::int64_t>{20, 40, 80, 160, 320, 640, 1000, 1000}));
}

TEST(Backoff, HalvesForEveryWholeSecondLived) {
  Backoff backoff;
  for (int i = 0; i < 7; ++i) (void)backoff.next(0);
  EXPECT_EQ(backoff.next(999'999), 1'000'000);
  EXPECT_EQ(backoff.next(1'000'000), 500'000);
  EXPECT_EQ(backoff.next(3'500'000), 62'500);
  EXPECT_EQ(backoff.next(100'000'000), 10'000);
  EXPECT_EQ(backoff.next(3'600'000'000'000), 10'000);
}

}  // namespace
}  // namespace curbstone::procman::process
