#include "services/mapper/local_map/delayed_result.hpp"

#include <gtest/gtest.h>

#include <future>
#include <memory>

namespace curbstone::mapper::local_map {
namespace {

class DelayedResultTest : public ::testing::TestWithParam<bool> {};

TEST_P(DelayedResultTest, IsTakenAtItsScanWhetherItWasThereSoonerOrNot) {
  DelayedResult<std::unique_ptr<int>> result(GetParam());
  EXPECT_FALSE(result.is_under_way());
  result.begin(3, [] { return std::make_unique<int>(7); });
  EXPECT_FALSE(result.next_scan());
  EXPECT_FALSE(result.next_scan());
  EXPECT_TRUE(result.is_under_way());
  const auto taken = result.next_scan();
  ASSERT_TRUE(taken);
  EXPECT_EQ(**taken, 7);
  EXPECT_FALSE(result.is_under_way());
}

TEST_P(DelayedResultTest, IsTakenAtOnceAtTheEndOfADrive) {
  DelayedResult<int> result(GetParam());
  EXPECT_FALSE(result.take());
  result.begin(10, [] { return 7; });
  EXPECT_EQ(result.take(), 7);
  EXPECT_FALSE(result.is_under_way());
}

TEST_P(DelayedResultTest, WhatIsCancelledIsNotUsedAnyMore) {
  DelayedResult<int> result(GetParam());
  result.begin(1, [] { return 7; });
  result.cancel();
  EXPECT_FALSE(result.is_under_way());
  result.begin(1, [] { return 8; });
  EXPECT_EQ(result.next_scan(), 8);
}

TEST(DelayedResult, TheCallerGoesOnMeanwhile) {
  std::promise<void> may_end;
  DelayedResult<int> result(true);
  result.begin(2, [end = may_end.get_future()]() mutable {
    end.wait();
    return 7;
  });
  EXPECT_FALSE(result.next_scan()) << "without waiting";
  may_end.set_value();
  EXPECT_EQ(result.next_scan(), 7);
}

INSTANTIATE_TEST_SUITE_P(Threaded, DelayedResultTest, ::testing::Bool());

}  // namespace
}  // namespace curbstone::mapper::local_map
