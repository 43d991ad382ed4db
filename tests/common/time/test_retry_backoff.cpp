#include "common/time/retry_backoff.hpp"

#include <gtest/gtest.h>

namespace curbstone {
namespace {

TEST(RetryBackoff, IsDueAtOnceBeforeAnythingFailed) {
  EXPECT_TRUE(RetryBackoff().due(0));
}

TEST(RetryBackoff, DoublesUpToHalfASecondAndBeginsAnewAfterALoss) {
  RetryBackoff pause;
  std::int64_t now = 1'000'000;
  for (const std::int64_t wait : {100'000, 200'000, 400'000, 500'000, 500'000}) {
    pause.failed(now);
    EXPECT_FALSE(pause.due(now + wait - 1)) << wait;
    EXPECT_TRUE(pause.due(now + wait)) << wait;
    now += wait;
  }
  pause.lost(now);
  EXPECT_FALSE(pause.due(now + RetryBackoff::kFirst - 1));
  EXPECT_TRUE(pause.due(now + RetryBackoff::kFirst));
}

}  // namespace
}  // namespace curbstone
