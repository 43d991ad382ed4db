#include "common/bus/counters.hpp"

#include <gtest/gtest.h>

namespace curbstone {
namespace {

Counters counted(std::int64_t packets, std::int64_t refused) {
  Counters counters;
  counters.add("packets", packets);
  counters.add("refused.length", refused);
  return counters;
}

TEST(Counters, AreAddedByName) {
  Counters counters;
  counters.add("packets", 3);
  counters.add(counted(4, 1));
  EXPECT_EQ(counters["packets"], 7);
  EXPECT_EQ(counters["refused.length"], 1);
}

TEST(Counters, AreReplacedByName) {
  Counters counters;
  counters.add("packets", 3);
  counters.add("difop", 2);
  counters.set(counted(4, 1));
  EXPECT_EQ(counters["packets"], 4);
  EXPECT_EQ(counters["refused.length"], 1);
  EXPECT_EQ(counters["difop"], 2);
}

}  // namespace
}  // namespace curbstone
