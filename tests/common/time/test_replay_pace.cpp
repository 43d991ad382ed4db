#include "common/time/replay_pace.hpp"

#include <gtest/gtest.h>

#include "tests/stamps.hpp"

namespace curbstone {
namespace {

using test::kStart;

TEST(ReplayPace, SpacesItemsAsTheyWereRecorded) {
  ReplayPace pace(2.0);
  EXPECT_TRUE(pace.due(kStart, 500));
  EXPECT_FALSE(pace.due(kStart + 1000, 999));
  EXPECT_TRUE(pace.due(kStart + 1000, 1000));
  EXPECT_FALSE(pace.due(kStart + 3000, 1999));
  EXPECT_TRUE(pace.due(kStart + 3000, 2000));
}

TEST(ReplayPace, WaitsForNoTimeThatIsDamagedNorForAPause) {
  ReplayPace pace(1.0);
  EXPECT_TRUE(pace.due(kStart, 0));
  EXPECT_TRUE(pace.due(kStart + 3'600'000'000, 0)) << "an hour ahead";
  EXPECT_TRUE(pace.due(kStart + 1000, 0)) << "and back";
  EXPECT_FALSE(pace.due(kStart + 2000, 999));
  EXPECT_TRUE(pace.due(kStart + 2000, 1000));
}

TEST(ReplayPace, OfZeroIsAtOnce) {
  ReplayPace pace(0.0);
  EXPECT_TRUE(pace.due(kStart, 0));
  EXPECT_TRUE(pace.due(kStart + 9'000'000, 0));
}

}  // namespace
}  // namespace curbstone
