#include "common/time/retry_pause.hpp"

#include <gtest/gtest.h>

namespace curbstone {
namespace {

TEST(RetryPause, IsDueAtOnceBeforeAnythingFailed) {
  EXPECT_TRUE(RetryPause().due(0));
}

TEST(RetryPause, DoublesUpToHalfASecondAndBeginsAnewAfterALoss) {
  RetryPause pause;
  std::int64_t now = 1'000'000;
  for (const std::int64_t wait : {100'000, 200'000, 400'000, 500'000, 500'000}) {
    pause.failed(now);
    EXPECT_FALSE(pause.due(now + wait - 1)) << wait;
    EXPECT_TRUE(pause.due(now + wait)) << wait;
    now += wait;
  }
  pause.lost(now);
  EXPECT_FALSE(pause.due(now + RetryPause::kFirst - 1));
  EXPECT_TRUE(pause.due(now + RetryPause::kFirst));
}

}  // namespace
}  // namespace curbstone
