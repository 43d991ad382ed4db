#include "common/tile_sync/lost_timer.hpp"

#include <gtest/gtest.h>

namespace curbstone {
namespace {

TEST(LostTimer, IsTakenOnceWhenTheVehicleHasBeenLostForLongEnough) {
  LostTimer pause(4'000'000);
  pause.on_pose(1'000'000, false);
  EXPECT_FALSE(pause.take());
  pause.on_pose(10'000'000, true);
  pause.on_pose(13'950'000, true);
  EXPECT_FALSE(pause.take());
  pause.on_pose(14'000'000, true);
  EXPECT_TRUE(pause.take());
  pause.on_pose(20'000'000, true);
  EXPECT_FALSE(pause.take());
}

TEST(LostTimer, BeginsAgainWhenTheVehicleIsFoundAndLostOnceMore) {
  LostTimer pause(4'000'000);
  for (const std::int64_t from : {10'000'000, 20'000'000}) {
    pause.on_pose(from, true);
    pause.on_pose(from + 4'000'000, true);
    EXPECT_TRUE(pause.take());
    pause.on_pose(from + 5'000'000, false);
    EXPECT_FALSE(pause.take());
  }
}

}  // namespace
}  // namespace curbstone
