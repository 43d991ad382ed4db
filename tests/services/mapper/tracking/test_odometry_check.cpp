#include "services/mapper/tracking/odometry_check.hpp"

#include <gmock/gmock.h>

#include <cmath>

namespace curbstone::mapper::tracking {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Pairs of scans a tenth of a second apart.
class OdometryCheckTest : public ::testing::Test {
 protected:
  /// m/s forward by odometry; m/s forward and to the left by the LiDAR.
  void pairs(int n, double odometry, double ahead, double left = 0, double agreement_with_odometry = 0.7) {
    for (int i = 0; i < n; ++i) {
      utime_ += 1'000'000;
      odometry_check_.add(
          {utime_, 0.1, {0.1 * odometry, 0}, {0.1 * ahead, 0.1 * left}, 0.01, 0.9, agreement_with_odometry});
    }
  }
  [[nodiscard]] std::string fault(double yaw = 0) const {
    std::vector<std::string> faults;
    odometry_check_.add_faults(faults, yaw);
    return faults.empty() ? "" : faults.front();
  }
  std::int64_t utime_ = 1'700'000'000'000'000;
  OdometryCheck odometry_check_;
};

TEST_F(OdometryCheckTest, TheSameWayIsNoFault) {
  pairs(20, 3, 3.2);
  pairs(20, 0, 0.3);
  pairs(20, 9, 8);
  EXPECT_FALSE(odometry_check_.rejects_odometry() || odometry_check_.heading_offset() || odometry_check_.is_suspect());
  EXPECT_THAT(fault(), IsEmpty());
}

TEST_F(OdometryCheckTest, OdometryThatStandsWhileTheVehicleDrivesIsDenied) {
  pairs(5, 3, 3);
  pairs(2, 0, 3);
  EXPECT_TRUE(odometry_check_.is_suspect());
  EXPECT_FALSE(odometry_check_.rejects_odometry()) << "not yet";
  pairs(1, 0, 3);
  EXPECT_TRUE(odometry_check_.rejects_odometry());
  EXPECT_THAT(fault(), HasSubstr("it goes 0.0 m/s where the LiDAR sees the vehicle go 3.0 m/s"));
  EXPECT_EQ(odometry_check_.counters()["faults.odometry.way"], 1);
}

TEST_F(OdometryCheckTest, UntilItIsRightAgain) {
  pairs(3, 3, 3);
  pairs(3, 6, 3);
  ASSERT_TRUE(odometry_check_.rejects_odometry());
  pairs(2, 3, 3);
  EXPECT_TRUE(odometry_check_.rejects_odometry());
  pairs(1, 3, 3);
  EXPECT_FALSE(odometry_check_.rejects_odometry());
  EXPECT_THAT(fault(), IsEmpty());
}

TEST_F(OdometryCheckTest, AVehicleThatStandsDoesNotPutItRight) {
  pairs(1, 3, 3);
  pairs(3, 0, 3);
  pairs(20, 0, 0);
  EXPECT_TRUE(odometry_check_.rejects_odometry());
  pairs(3, 0, 3);
  EXPECT_EQ(odometry_check_.counters()["faults.odometry.way"], 1);
}

TEST_F(OdometryCheckTest, ALidarThatStopsOrSetsOffWhereOdometryDoesNotIsNotBelieved) {
  pairs(5, 3, 3);
  pairs(3, 3, 0);
  EXPECT_TRUE(odometry_check_.disagrees());
  EXPECT_FALSE(odometry_check_.rejects_odometry()) << "lorries on both sides come along";
  EXPECT_THAT(fault(), HasSubstr("or does something large drive along beside it"));
  odometry_check_ = OdometryCheck();
  pairs(5, 0, 0);
  pairs(3, 0, -2);
  EXPECT_TRUE(odometry_check_.disagrees());
  EXPECT_FALSE(odometry_check_.rejects_odometry()) << "they set off, and the vehicle stands";
}

TEST_F(OdometryCheckTest, TwoThatDifferAndOneThatDoesNotAreNoFault) {
  for (int i = 0; i < 10; ++i) {
    pairs(2, 0, 3);
    pairs(1, 3, 3);
  }
  EXPECT_THAT(fault(), IsEmpty());
}

TEST_F(OdometryCheckTest, PairsThatShowOdometrysWayAsWellSayNothing) {
  pairs(20, 0, 3, 0, 0.89);
  EXPECT_FALSE(odometry_check_.rejects_odometry() || odometry_check_.is_suspect());
}

TEST_F(OdometryCheckTest, ALidarThatLooksBackwardsOrAsideIsNamedWithItsYaw) {
  pairs(3, 3, -2.9, 0.1);
  ASSERT_TRUE(odometry_check_.heading_offset());
  EXPECT_FALSE(odometry_check_.rejects_odometry());
  EXPECT_NEAR(std::abs(*odometry_check_.heading_offset()), 3.14, 0.05);
  EXPECT_THAT(fault(), ::testing::ContainsRegex("drive 17. deg to the left .* the yaw in vehicle.lidar is -3.1"));
  EXPECT_EQ(odometry_check_.counters()["faults.lidar.aside"], 1);
  odometry_check_ = OdometryCheck();
  pairs(3, 0.5, -0.5);
  EXPECT_TRUE(odometry_check_.heading_offset()) << "as it drives off";
  odometry_check_ = OdometryCheck();
  pairs(3, 2, 0, 2);
  ASSERT_TRUE(odometry_check_.heading_offset());
  EXPECT_NEAR(*odometry_check_.heading_offset(), 1.571, 0.01);
  EXPECT_THAT(fault(0.2),
              HasSubstr("drive 90 deg to the left of where odometry does: the map is wrong. Is it mounted so? "
                        "Then the yaw in vehicle.lidar is -1.37, and not 0.20"));
}

TEST_F(OdometryCheckTest, AVehicleThatReversesDrivesBackwardsByBoth) {
  pairs(10, -2, -2);
  EXPECT_THAT(fault(), IsEmpty());
  odometry_check_ = OdometryCheck();
  pairs(3, -2, 2);
  EXPECT_TRUE(odometry_check_.heading_offset());
}

}  // namespace
}  // namespace curbstone::mapper::tracking
