#include "common/tile_sync/lost_pause.hpp"

#include <gtest/gtest.h>

namespace curbstone {
namespace {

TEST(LostPause, IsTakenOnceWhenTheVehicleHasBeenLostForLongEnough) {
  LostPause pause(4'000'000);
  pause.hear(1'000'000, false);
  EXPECT_FALSE(pause.take());
  pause.hear(10'000'000, true);
  pause.hear(13'950'000, true);
  EXPECT_FALSE(pause.take());
  pause.hear(14'000'000, true);
  EXPECT_TRUE(pause.take());
  pause.hear(20'000'000, true);
  EXPECT_FALSE(pause.take());
}

TEST(LostPause, BeginsAgainWhenTheVehicleIsFoundAndLostOnceMore) {
  LostPause pause(4'000'000);
  for (const std::int64_t from : {10'000'000, 20'000'000}) {
    pause.hear(from, true);
    pause.hear(from + 4'000'000, true);
    EXPECT_TRUE(pause.take());
    pause.hear(from + 5'000'000, false);
    EXPECT_FALSE(pause.take());
  }
}

}  // namespace
}  // namespace curbstone
