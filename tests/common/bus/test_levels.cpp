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

TEST(Levels, MayHaveATextInTheirNames) {
  EXPECT_TRUE(is_level("device.serial_number.33C1160BAAA"));
  EXPECT_FALSE(is_level("device.serial_number"));
  EXPECT_FALSE(is_level("device.serial_number.1.2"));
  EXPECT_FALSE(is_level("device.other.33C1160BAAA"));
  Counters counters;
  set_text(counters, "device.serial_number", "33C1160BAAA");
  set_text(counters, "device.firmware", "");
  EXPECT_EQ(counters["device.serial_number.33C1160BAAA"], 1);
  EXPECT_EQ(counters.values().size(), 1U);
}

}  // namespace
}  // namespace curbstone
