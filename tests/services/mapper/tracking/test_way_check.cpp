#include "services/mapper/tracking/way_check.hpp"

#include <gmock/gmock.h>

#include <cmath>

namespace curbstone::mapper::tracking {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Pairs of scans a tenth of a second apart.
class WayCheckTest : public ::testing::Test {
 protected:
  /// m/s forward by odometry; m/s forward and to the left by the LiDAR.
  void pairs(int n, double odometry, double ahead, double left = 0, double agreement_with_odometry = 0.7) {
    for (int i = 0; i < n; ++i) {
      utime_ += 1'000'000;
      way_.add({utime_, 0.1, {0.1 * odometry, 0}, {0.1 * ahead, 0.1 * left}, 0.01, 0.9, agreement_with_odometry});
    }
  }
  [[nodiscard]] std::string fault(double yaw = 0) const {
    std::vector<std::string> faults;
    way_.add_faults(faults, yaw);
    return faults.empty() ? "" : faults.front();
  }
  std::int64_t utime_ = 1'700'000'000'000'000;
  WayCheck way_;
};

TEST_F(WayCheckTest, TheSameWayIsNoFault) {
  pairs(20, 3, 3.2);
  pairs(20, 0, 0.3);
  pairs(20, 9, 8);
  EXPECT_FALSE(way_.denied() || way_.aside() || way_.in_doubt());
  EXPECT_THAT(fault(), IsEmpty());
}

TEST_F(WayCheckTest, OdometryThatStandsWhileTheVehicleDrivesIsDenied) {
  pairs(5, 3, 3);
  pairs(2, 0, 3);
  EXPECT_TRUE(way_.in_doubt());
  EXPECT_FALSE(way_.denied()) << "not yet";
  pairs(1, 0, 3);
  EXPECT_TRUE(way_.denied());
  EXPECT_THAT(fault(), HasSubstr("it goes 0.0 m/s where the LiDAR sees the vehicle go 3.0 m/s"));
  EXPECT_EQ(way_.counters()["faults.odometry.way"], 1);
}

TEST_F(WayCheckTest, UntilItIsRightAgain) {
  pairs(3, 3, 3);
  pairs(3, 6, 3);
  ASSERT_TRUE(way_.denied());
  pairs(2, 3, 3);
  EXPECT_TRUE(way_.denied());
  pairs(1, 3, 3);
  EXPECT_FALSE(way_.denied());
  EXPECT_THAT(fault(), IsEmpty());
}

TEST_F(WayCheckTest, AVehicleThatStandsDoesNotPutItRight) {
  pairs(1, 3, 3);
  pairs(3, 0, 3);
  pairs(20, 0, 0);
  EXPECT_TRUE(way_.denied());
  pairs(3, 0, 3);
  EXPECT_EQ(way_.counters()["faults.odometry.way"], 1);
}

TEST_F(WayCheckTest, ALidarThatStopsOrSetsOffWhereOdometryDoesNotIsNotBelieved) {
  pairs(5, 3, 3);
  pairs(3, 3, 0);
  EXPECT_TRUE(way_.apart());
  EXPECT_FALSE(way_.denied()) << "lorries on both sides come along";
  EXPECT_THAT(fault(), HasSubstr("or does something large drive along beside it"));
  way_ = WayCheck();
  pairs(5, 0, 0);
  pairs(3, 0, -2);
  EXPECT_TRUE(way_.apart());
  EXPECT_FALSE(way_.denied()) << "they set off, and the vehicle stands";
}

TEST_F(WayCheckTest, TwoThatDifferAndOneThatDoesNotAreNoFault) {
  for (int i = 0; i < 10; ++i) {
    pairs(2, 0, 3);
    pairs(1, 3, 3);
  }
  EXPECT_THAT(fault(), IsEmpty());
}

TEST_F(WayCheckTest, PairsThatShowOdometrysWayAsWellSayNothing) {
  pairs(20, 0, 3, 0, 0.89);
  EXPECT_FALSE(way_.denied() || way_.in_doubt());
}

TEST_F(WayCheckTest, ALidarThatLooksBackwardsOrAsideIsNamedWithItsYaw) {
  pairs(3, 3, -2.9, 0.1);
  ASSERT_TRUE(way_.aside());
  EXPECT_FALSE(way_.denied());
  EXPECT_NEAR(std::abs(*way_.aside()), 3.14, 0.05);
  EXPECT_THAT(fault(), ::testing::ContainsRegex("drive 17. deg to the left .* the yaw in vehicle.lidar is -3.1"));
  EXPECT_EQ(way_.counters()["faults.lidar.aside"], 1);
  way_ = WayCheck();
  pairs(3, 0.5, -0.5);
  EXPECT_TRUE(way_.aside()) << "as it drives off";
  way_ = WayCheck();
  pairs(3, 2, 0, 2);
  ASSERT_TRUE(way_.aside());
  EXPECT_NEAR(*way_.aside(), 1.571, 0.01);
  EXPECT_THAT(fault(0.2),
              HasSubstr("drive 90 deg to the left of where odometry does: the map is wrong. Is it mounted so? "
                        "Then the yaw in vehicle.lidar is -1.37, and not 0.20"));
}

TEST_F(WayCheckTest, AVehicleThatReversesDrivesBackwardsByBoth) {
  pairs(10, -2, -2);
  EXPECT_THAT(fault(), IsEmpty());
  way_ = WayCheck();
  pairs(3, -2, 2);
  EXPECT_TRUE(way_.aside());
}

}  // namespace
}  // namespace curbstone::mapper::tracking
