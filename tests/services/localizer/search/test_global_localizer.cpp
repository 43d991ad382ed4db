#include "services/localizer/search/global_localizer.hpp"

#include <gtest/gtest.h>

#include "tests/services/localizer/yard.hpp"

namespace curbstone::localizer::search {
namespace {

using test_yard::map_of;
using test_yard::points_in;
using test_yard::pose_at;
using test_yard::Yard;

/// 0.15 m a revolution through the yard, on a gentle bend; odometry has an origin of its own.
struct DriveThrough {
  Yard yard;
  fields::SavedMap map;
  GlobalLocalizer localizer{tracking::TrackingConfig{}};
  Pose T_map_base = pose_at(-8, -1, 0.2);
  Pose T_odom_map = pose_at(20, 5, 2.0);
  bool was_ambiguous = false;

  std::optional<tracking::PoseBelief> revolution(double step = 0.15) {
    tracking::Motion motion;
    motion.seconds = 0.05;
    motion.T_last_base = pose_at(step, 0, 0.1 * step);
    T_map_base = T_map_base * motion.T_last_base;
    const auto found = localizer.process(points_in(yard, T_map_base), T_odom_map * T_map_base, motion, map);
    was_ambiguous = was_ambiguous || localizer.ambiguous();
    return found;
  }
  std::optional<tracking::PoseBelief> revolutions(int most) {
    for (int i = 0; i < most; ++i) {
      if (auto found = revolution()) return found;
    }
    return std::nullopt;
  }
};

TEST(GlobalLocalizer, FindsAVehicleThatDrivesInAYard) {
  DriveThrough drive{{.open = true}, fields::SavedMap(map_of(Yard{.open = true}))};
  const auto found = drive.revolutions(100);
  ASSERT_TRUE(found);
  EXPECT_LT(tracking::error_between(drive.T_map_base, found->T_map_base).head<2>().norm(), 0.05);
  EXPECT_FALSE(drive.was_ambiguous);
}

TEST(GlobalLocalizer, AtAPlaceThatTheMapHasTwiceItIsNeverSure) {
  DriveThrough drive{{.open = true}, fields::SavedMap(test_yard::twice(map_of(Yard{.open = true}), 40))};
  EXPECT_FALSE(drive.revolutions(100));
  EXPECT_TRUE(drive.was_ambiguous);
  ASSERT_NE(drive.localizer.best(), nullptr);
}

TEST(GlobalLocalizer, OnAMapOfAnotherPlaceItIsNeverSure) {
  DriveThrough drive{{.open = true},
                     fields::SavedMap(map_of({.half_length = 8.3, .half_width = 9.4, .turned = -0.5, .curb = 2}))};
  EXPECT_FALSE(drive.revolutions(100));
  EXPECT_GE(drive.localizer.searches(), 1);
}

TEST(GlobalLocalizer, WhileTheVehicleStandsItIsNotSure) {
  DriveThrough drive{{.open = true}, fields::SavedMap(map_of(Yard{.open = true}))};
  for (int i = 0; i < 120; ++i) ASSERT_FALSE(drive.revolution(0)) << i;
  ASSERT_NE(drive.localizer.best(), nullptr) << "but has a guess";
  EXPECT_LT((drive.localizer.best()->belief.T_map_base.translation() - drive.T_map_base.translation()).head<2>().norm(),
            0.05);
}

TEST(GlobalLocalizer, BeginsAgainWhenToldTo) {
  DriveThrough drive{{.open = true}, fields::SavedMap(map_of(Yard{.open = true}))};
  drive.revolutions(30);
  drive.localizer.restart();
  EXPECT_EQ(drive.localizer.best(), nullptr);
  EXPECT_TRUE(drive.revolutions(60));
}

}  // namespace
}  // namespace curbstone::localizer::search
