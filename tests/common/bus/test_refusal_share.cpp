#include "common/bus/refusal_share.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "tests/stamps.hpp"

namespace curbstone {
namespace {

using test::kSecond;

/// A second of 1000 packets of which `refused` are, in turn for two causes, the second of which is rarer.
void feed(RefusalShare& share, std::int64_t from, int refused) {
  for (int i = 0; i < 1000; ++i) {
    const std::int64_t now = from + i * 1000;
    if (i >= refused)
      share.used(now);
    else
      share.refused(now, i % 3 == 0 ? "refused.length" : "refused.magic");
  }
}

TEST(RefusalShare, IsNoFaultAtOnePacketInTwenty) {
  RefusalShare share;
  feed(share, 0, 50);
  share.tick(kSecond);
  EXPECT_FALSE(share.fault());
}

TEST(RefusalShare, IsAFaultAboveAndNamesTheCommonestCause) {
  RefusalShare share;
  feed(share, 0, 600);
  EXPECT_FALSE(share.fault()) << "the second has not ended";
  share.tick(kSecond);
  ASSERT_TRUE(share.fault());
  EXPECT_EQ(*share.fault(), "60 % of the packets of a second were refused, most of them refused.magic (400 of 1000)");
}

TEST(RefusalShare, EndsWithASecondThatIsWell) {
  RefusalShare share;
  feed(share, 0, 600);
  feed(share, kSecond, 0);
  EXPECT_TRUE(share.fault());
  share.tick(2 * kSecond);
  EXPECT_FALSE(share.fault());
}

TEST(RefusalShare, EndsWhenNothingComesAnyMore) {
  RefusalShare share;
  feed(share, 0, 600);
  share.tick(kSecond);
  share.tick(2 * kSecond);
  EXPECT_FALSE(share.fault());
}

TEST(RefusalShare, DoesNotJudgeAHandfulOfPackets) {
  RefusalShare share;
  for (int i = 0; i < 9; ++i) share.refused(i, "refused.magic");
  share.tick(kSecond);
  EXPECT_FALSE(share.fault());
}

TEST(RefusalShare, BeginsAgainWhenTheClockIsSetBack) {
  RefusalShare share;
  feed(share, 100 * kSecond, 600);
  feed(share, 0, 600);
  share.tick(kSecond);
  EXPECT_TRUE(share.fault());
}

}  // namespace
}  // namespace curbstone
