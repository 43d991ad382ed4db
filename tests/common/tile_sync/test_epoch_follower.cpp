#include "common/tile_sync/epoch_follower.hpp"

#include <gtest/gtest.h>

namespace curbstone {
namespace {

using Source = EpochFollower::Source;
using Verdict = EpochFollower::Verdict;

constexpr std::int32_t kEpoch = 1'700'000'000;
constexpr std::int64_t kNow = std::int64_t{kEpoch} * 1'000'000 + 30'000'000;

class EpochFollowerTest : public testing::Test {
 protected:
  Verdict mapper(std::int32_t epoch) { return follower_.observe(epoch, Source::kMapper, kNow); }
  Verdict other(std::int32_t epoch) { return follower_.observe(epoch, Source::kOther, kNow); }
  EpochFollower follower_;
};

TEST_F(EpochFollowerTest, EntersTheFirstEpochAtOnce) {
  EXPECT_EQ(other(kEpoch), Verdict::kEntered);
  EXPECT_EQ(mapper(kEpoch), Verdict::kPresent);
  EXPECT_FALSE(follower_.fault(kNow));
}

TEST_F(EpochFollowerTest, DoesNotBeginWithAnEpochFarAhead) {
  EXPECT_EQ(other(kEpoch + 1000), Verdict::kOther);
  EXPECT_EQ(other(kEpoch), Verdict::kEntered);
}

TEST_F(EpochFollowerTest, EntersANewerOneWhenASecondMessageAgreesWithTheMapper) {
  mapper(kEpoch);
  EXPECT_EQ(mapper(kEpoch + 20), Verdict::kCandidate);
  EXPECT_EQ(other(kEpoch + 20), Verdict::kEntered);
  EXPECT_EQ(*follower_.epoch(), kEpoch + 20);
}

TEST_F(EpochFollowerTest, KeepsACandidateWhileOthersStillSpeakOfThePresentEpoch) {
  mapper(kEpoch);
  EXPECT_EQ(mapper(kEpoch + 20), Verdict::kCandidate);
  EXPECT_EQ(other(kEpoch), Verdict::kPresent);
  EXPECT_EQ(mapper(kEpoch + 20), Verdict::kEntered);
}

TEST_F(EpochFollowerTest, IsNotMovedByOneDamagedAnnouncement) {
  mapper(kEpoch);
  for (int i = 0; i < 1000; ++i) {
    EXPECT_EQ(mapper(kEpoch + 8), Verdict::kCandidate);
    EXPECT_EQ(mapper(kEpoch), Verdict::kPresent);
  }
  EXPECT_EQ(*follower_.epoch(), kEpoch);
  EXPECT_FALSE(follower_.fault(kNow));
}

TEST_F(EpochFollowerTest, IsNotMovedByAnybodyButTheMapper) {
  mapper(kEpoch);
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(other(kEpoch + 8), Verdict::kOther);
  EXPECT_EQ(*follower_.epoch(), kEpoch);
}

TEST_F(EpochFollowerTest, IsNotMovedByAFewAnnouncementsFarAhead) {
  mapper(kEpoch);
  for (int i = 0; i < EpochFollower::kFollowAfter - 1; ++i) EXPECT_EQ(mapper(2'147'483'000), Verdict::kCandidate);
  EXPECT_EQ(mapper(kEpoch), Verdict::kPresent);
  EXPECT_EQ(mapper(2'147'483'000), Verdict::kCandidate);
}

TEST_F(EpochFollowerTest, FollowsAMapperWhoseClockWasSetBackAndSaysSo) {
  mapper(kEpoch);
  for (int i = 0; i < EpochFollower::kFollowAfter - 1; ++i) EXPECT_EQ(mapper(1000), Verdict::kCandidate);
  EXPECT_EQ(mapper(1000), Verdict::kEntered);
  EXPECT_EQ(*follower_.epoch(), 1000);
  EXPECT_TRUE(follower_.fault(kNow));
  EXPECT_FALSE(follower_.fault(kNow + EpochFollower::kFaultFor));
}

TEST_F(EpochFollowerTest, FollowsAMapperThatGoesOnWithAMapOfLaterThanTheClock) {
  const std::int64_t boot = 1'000'000;  // a computer without a battery begins in 1970
  for (int i = 0; i < EpochFollower::kFollowAfter - 1; ++i)
    EXPECT_EQ(follower_.observe(kEpoch, Source::kMapper, boot), Verdict::kCandidate);
  EXPECT_EQ(follower_.observe(kEpoch, Source::kMapper, boot), Verdict::kEntered);
}

TEST_F(EpochFollowerTest, NamesFiftyMessagesInARowOfAnotherEpoch) {
  mapper(kEpoch);
  for (int i = 0; i < EpochFollower::kFollowAfter; ++i) other(kEpoch - 100);
  ASSERT_TRUE(follower_.fault(kNow));
  EXPECT_NE(follower_.fault(kNow)->find("1699999900"), std::string::npos) << *follower_.fault(kNow);
  other(kEpoch);
  EXPECT_FALSE(follower_.fault(kNow));
}

}  // namespace
}  // namespace curbstone
