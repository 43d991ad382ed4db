#include "services/tensor_voting/worker/publish_schedule.hpp"

#include <gtest/gtest.h>

namespace curbstone::tensor_voting::worker {
namespace {

constexpr std::int64_t kMs = 1000;
constexpr std::int64_t kNow = 1'000'000'000;
const TileKey kHere{0, 0};
const TileKey kThere{10, 0};  // 30 m ahead

PublishSchedule schedule() {
  return PublishSchedule({.min_interval = 200 * kMs, .patience = 1000 * kMs, .near = 10});
}

TEST(PublishScheduleTest, TheNearestOfThoseWithNewsGoesFirst) {
  PublishSchedule s = schedule();
  s.changed(kThere, 100, kNow, kNow);
  s.changed(kHere, 100, kNow, kNow);
  EXPECT_EQ(s.next(kNow, 0, 0), kHere);
  EXPECT_EQ(s.next(kNow, 30, 0), kThere) << "seen from there";
  s.published(kHere, 100, kNow);
  EXPECT_EQ(s.next(kNow, 0, 0), kThere);
  s.published(kThere, 100, kNow);
  EXPECT_EQ(s.next(kNow, 0, 0), std::nullopt);
  EXPECT_EQ(s.any(), std::nullopt) << "none waits for its interval either";
}

TEST(PublishScheduleTest, TilesGoOutWhenTheHostsClockIsSetBackToo) {
  constexpr std::int64_t kBefore = kNow - 900'000 * kMs;
  PublishSchedule s = schedule();
  s.published(kHere, 100, kNow);
  s.changed(kThere, 100, kNow, kNow);
  EXPECT_EQ(s.next(kBefore, 0, 0), kThere) << "though it changed in the future";
  s.published(kThere, 100, kBefore);
  s.changed(kHere, 200, kBefore, kBefore);
  EXPECT_EQ(s.next(kBefore, 0, 0), kHere) << "though it was sent in the future";
  s.published(kHere, 200, kBefore);
  s.changed(kHere, 300, kBefore, kBefore);
  EXPECT_EQ(s.next(kBefore, 0, 0), std::nullopt) << "its interval counts from then";
  EXPECT_EQ(s.next(kBefore + 200 * kMs, 0, 0), kHere);
}

TEST(PublishScheduleTest, TheLargestShareOfNewsGoesFirst) {
  PublishSchedule s = schedule();
  const TileKey beside{0, 1};
  s.published(kHere, 100, kNow - 5000 * kMs);
  s.published(beside, 100, kNow - 5000 * kMs);
  s.changed(kHere, 125, kNow, kNow);
  s.changed(beside, 400, kNow, kNow);
  EXPECT_EQ(s.next(kNow, 1.5, 3), beside);
}

TEST(PublishScheduleTest, WhatIsFarAwayComesToItsTurnInTheEnd) {
  PublishSchedule s = schedule();
  s.published(kHere, 100, kNow - 10'000 * kMs);
  s.changed(kThere, 100, kNow - 400'000 * kMs, kNow - 400'000 * kMs);
  s.changed(kHere, 300, kNow, kNow);
  EXPECT_EQ(s.next(kNow, 0, 0), kThere) << "it has waited for long";
}

TEST(PublishScheduleTest, WhenNotAllCanGoFreshNewsGoesFirst) {
  PublishSchedule s = schedule();
  const TileKey beside{0, 1};
  s.changed(kHere, 100, kNow, kNow);
  s.changed(beside, 100, kNow, kNow);
  s.changed(beside, 150, kNow + 100 * kMs, kNow + 100 * kMs);
  EXPECT_EQ(s.next(kNow + 120 * kMs, 1.5, 1.5), beside) << "further away, but its points have just been measured";
  s.changed(kHere, 150, kNow + 200 * kMs, kNow + 200 * kMs);
  EXPECT_EQ(s.next(kNow + 220 * kMs, 1.5, 1.5), kHere);
}

TEST(PublishScheduleTest, StrangeClocksDoNoHarm) {
  PublishSchedule s = schedule();
  const std::int64_t long_ago = kNow - 365LL * 86'400'000 * kMs;  // a recording that is played again
  s.changed(kThere, 100, long_ago, kNow);
  s.changed(kHere, 100, long_ago, kNow);
  EXPECT_EQ(s.next(kNow, 0, 0), kHere);
  s.changed(kThere, 110, kNow + 3'600'000 * kMs, kNow);
  EXPECT_EQ(s.next(kNow, 30, 0), kThere);
}

TEST(PublishScheduleTest, NoTileGoesMoreOftenThanItMay) {
  PublishSchedule s = schedule();
  s.changed(kHere, 100, kNow, kNow);
  s.published(kHere, 100, kNow);
  s.changed(kHere, 200, kNow + 50 * kMs, kNow + 50 * kMs);
  EXPECT_EQ(s.next(kNow + 199 * kMs, 0, 0), std::nullopt);
  EXPECT_EQ(s.next(kNow + 200 * kMs, 0, 0), kHere);
}

TEST(PublishScheduleTest, ASinglePointIsNewsToo) {
  PublishSchedule s = schedule();
  s.changed(kHere, 1000, kNow, kNow);
  s.published(kHere, 1000, kNow);
  s.changed(kHere, 1001, kNow + 500 * kMs, kNow + 500 * kMs);
  EXPECT_EQ(s.next(kNow + 500 * kMs, 0, 0), kHere);
}

TEST(PublishScheduleTest, LittleNewsThatHasWaitedGoesBeforeMuchThatHasNot) {
  PublishSchedule s = schedule();
  const TileKey beside{0, 1};
  s.published(kHere, 1000, kNow - 5000 * kMs);
  s.published(beside, 1000, kNow - 5000 * kMs);
  s.changed(kHere, 1001, kNow - 1000 * kMs, kNow - 1000 * kMs);
  s.changed(beside, 2000, kNow, kNow);
  EXPECT_EQ(s.next(kNow, 1.5, 3), kHere);
  s.published(kHere, 1001, kNow);
  s.changed(kHere, 1002, kNow + 200 * kMs, kNow + 200 * kMs);
  EXPECT_EQ(s.next(kNow + 200 * kMs, 1.5, 3), beside);
}

TEST(PublishScheduleTest, WhoAsksGetsATileThatHasNotChanged) {
  PublishSchedule s = schedule();
  s.changed(kHere, 100, kNow, kNow);
  s.published(kHere, 100, kNow);
  s.wanted(kHere, kNow + 50 * kMs);
  EXPECT_EQ(s.next(kNow + 250 * kMs, 0, 0), kHere);
  EXPECT_EQ(s.waiting_since(kHere), kNow + 50 * kMs);
  s.published(kHere, 100, kNow + 250 * kMs);
  EXPECT_FALSE(s.is_pending(kHere));
}

TEST(PublishScheduleTest, WhatAnotherHasPublishedIsNotPublishedAgain) {
  PublishSchedule s = schedule();
  s.changed(kHere, 100, kNow, kNow);
  s.published(kHere, 100, 0);
  EXPECT_FALSE(s.is_pending(kHere));
  s.changed(kHere, 90, kNow, kNow);
  EXPECT_FALSE(s.is_pending(kHere)) << "we are behind";
  s.changed(kHere, 150, kNow, kNow);
  EXPECT_EQ(s.next(kNow, 0, 0), kHere);
}

TEST(PublishScheduleTest, WhatItRemembersIsBounded) {
  PublishSchedule s = schedule();
  const auto count = static_cast<std::int32_t>(PublishSchedule::kMaxRemembered) + 1;
  for (std::int32_t i = 0; i < count; ++i) s.published({i, 0}, 1, kNow);
  EXPECT_FALSE(s.has_forgotten());
  s.forget_far(0, 0, 300);
  EXPECT_TRUE(s.has_forgotten());
  EXPECT_EQ(s.published_revision({50, 0}), 1);
  EXPECT_EQ(s.published_revision({200, 0}), 0);
}

}  // namespace
}  // namespace curbstone::tensor_voting::worker
