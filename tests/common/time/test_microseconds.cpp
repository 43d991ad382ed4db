#include "common/time/microseconds.hpp"

#include <gtest/gtest.h>

namespace curbstone {
namespace {

TEST(Microseconds, AreTheNearestWholeOnes) {
  EXPECT_EQ(microseconds(0.0), 0);
  EXPECT_EQ(microseconds(2.5), 2'500'000);
  EXPECT_EQ(microseconds(1.4e-6), 1);
  EXPECT_EQ(microseconds(1.6e-6), 2);
  EXPECT_EQ(microseconds(0.5e-6), 1) << "a half goes away from zero";
  EXPECT_EQ(microseconds(-0.5e-6), -1);
  EXPECT_EQ(microseconds(-1.6e-6), -2);
}

TEST(Microseconds, OfWholeMillisecondsAreExact) {
  for (std::int64_t ms = 0; ms <= 100'000; ++ms) {
    ASSERT_EQ(microseconds(static_cast<double>(ms) / 1000), ms * 1000) << ms << " ms";
  }
}

}  // namespace
}  // namespace curbstone
