#include "common/bus/sequence_number.hpp"

#include <gtest/gtest.h>

namespace curbstone {
namespace {

TEST(SequenceNumber, CountsOnFromZeroWhereItEnds) {
  EXPECT_EQ(next_sequence_number(0), 1);
  EXPECT_EQ(next_sequence_number(2147483646), 2147483647);
  EXPECT_EQ(next_sequence_number(2147483647), 0);
  EXPECT_EQ(next_sequence_number(2147483640, 10), 2);
}

}  // namespace
}  // namespace curbstone
