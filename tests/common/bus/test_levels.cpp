#include "common/bus/levels.hpp"

#include <gtest/gtest.h>

namespace curbstone {
namespace {

TEST(Levels, AreByTheirNames) {
  EXPECT_TRUE(is_level("clock.difference_us"));
  EXPECT_TRUE(is_level("tiles"));
  EXPECT_FALSE(is_level("clock.jumps"));
  EXPECT_FALSE(is_level("clock"));
  EXPECT_FALSE(is_level(""));
}

TEST(Levels, AreSetAmongTheCounters) {
  Counters counters;
  set_level(counters, "tiles_waiting", 7);
  set_level(counters, "tiles_waiting", 3);
  EXPECT_EQ(counters["tiles_waiting"], 3);
}

}  // namespace
}  // namespace curbstone
