#include "common/time/has_passed.hpp"

#include <gtest/gtest.h>

namespace curbstone {
namespace {

TEST(HasPassed, APeriodAfterItsBeginning) {
  EXPECT_FALSE(has_passed(10, 100, 100));
  EXPECT_FALSE(has_passed(10, 100, 109));
  EXPECT_TRUE(has_passed(10, 100, 110));
  EXPECT_TRUE(has_passed(0, 100, 100));
}

TEST(HasPassed, AtOnceWhenTheClockIsSetBack) {
  EXPECT_TRUE(has_passed(10, 100, 99));
  EXPECT_TRUE(has_passed(10, 100, -3'600'000'000));
}

}  // namespace
}  // namespace curbstone
