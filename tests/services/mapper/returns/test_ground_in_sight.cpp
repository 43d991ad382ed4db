#include "services/mapper/returns/ground_in_sight.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdint>

#include "tests/services/mapper/detection_scans.hpp"

namespace curbstone::mapper::returns {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int kSoon = GroundInSight::kEvery * GroundInSight::kLooks;  // revolutions

struct Sight {
  test::DetectionScans drive;
  GroundInSight ground{test::default_lidar()};
  bool moves = false;

  /// What comes from the ground beyond `from` m is lost.
  void check(int revolutions, double from = INFINITY) {
    scan::Scan scan = drive.next();
    const Pose T_base_lidar = test::default_lidar();
    std::erase_if(scan.points, [&](const scan::LidarPoint& point) {
      const Eigen::Vector3d p = T_base_lidar * point.position.cast<double>();
      return p.z() < 0.1 && p.head<2>().norm() > from;
    });
    for (int i = 0; i < revolutions; ++i) ground.check(scan, moves);
  }
  [[nodiscard]] std::vector<std::string> faults() const {
    std::vector<std::string> faults;
    ground.add_faults(faults);
    return faults;
  }
};

TEST(GroundInSight, AStreetShowsItsGround) {
  Sight sight;
  sight.check(10 * kSoon);
  EXPECT_GT(sight.ground.share(), 0.9);
  EXPECT_THAT(sight.faults(), IsEmpty());
}

TEST(GroundInSight, ALidarThatHangsUpsideDownSeesItAboveItself) {
  Sight sight;
  sight.drive.T_base_lidar = test::default_lidar() * test::pose(0, 0, 0, M_PI, 0, 0);
  sight.check(kSoon - GroundInSight::kEvery);
  EXPECT_THAT(sight.faults(), IsEmpty()) << "not yet";
  sight.check(GroundInSight::kEvery);
  ASSERT_EQ(sight.faults().size(), 1U);
  EXPECT_THAT(sight.faults()[0], HasSubstr("the ground is above it"));
  EXPECT_EQ(sight.ground.counters()["faults.lidar.upside_down"], 1);
  sight.drive.T_base_lidar = test::default_lidar();
  sight.check(kSoon);
  EXPECT_FALSE(sight.ground.is_upside_down());
}

TEST(GroundInSight, UnderACeilingItHasAFloor) {
  Sight sight;
  scan::Scan scan = sight.drive.next();
  const std::size_t points = scan.points.size();
  for (std::size_t i = 0; i < points; ++i) {
    scan::LidarPoint mirrored = scan.points[i];
    mirrored.position.z() = -mirrored.position.z();
    scan.points.push_back(mirrored);
  }
  for (int i = 0; i < 2 * kSoon; ++i) sight.ground.check(scan, false);
  EXPECT_FALSE(sight.ground.is_upside_down());
}

TEST(GroundInSight, ADirtyWindowOrAWetRoadIsAFaultUntilTheGroundIsBack) {
  Sight sight;
  sight.check(kSoon - GroundInSight::kEvery, 6.0);
  EXPECT_THAT(sight.faults(), IsEmpty()) << "not yet";
  sight.check(GroundInSight::kEvery, 6.0);
  ASSERT_EQ(sight.faults().size(), 1U);
  EXPECT_THAT(sight.faults()[0], HasSubstr("no ground in sight beyond 6 m in 100 % of the open directions about it"));
  sight.check(kSoon);
  EXPECT_THAT(sight.faults(), IsEmpty());
  sight.check(3 * kSoon, 6.0);
  EXPECT_EQ(sight.faults().size(), 1U) << "in mid-drive too";
  EXPECT_EQ(sight.ground.counters()["faults.no_ground"], 2);
}

/// Behind it the ground is in sight.
TEST(GroundInSight, ALidarThatIsTiltedUpIsAFaultOnceTheVehicleMoves) {
  for (const double degrees : {10.0, 15.0}) {
    for (const bool moves : {false, true}) {
      Sight sight;
      sight.moves = moves;
      sight.drive.T_base_lidar = test::pose(0, 0, 1.73, 0, -degrees * 3.14159265358979 / 180, 0);
      sight.drive.world = test::plain();
      sight.drive.world.boxes.push_back({{-60, 25, 0}, {60, 26, 30}});
      sight.drive.world.boxes.push_back({{-60, -26, 0}, {60, -25, 30}});
      sight.drive.world.boxes.push_back({{60, -26, 0}, {61, 26, 30}});
      sight.drive.world.boxes.push_back({{-61, -26, 0}, {-60, 26, 30}});
      sight.check(kSoon);
      ASSERT_EQ(sight.faults().size(), moves ? 1U : 0U) << degrees << ": " << sight.ground.share_ahead();
      if (moves) {
        EXPECT_THAT(sight.faults()[0], HasSubstr("in 100 % of the open directions ahead"));
      }
    }
  }
}

TEST(GroundInSight, WhatFallsAwayBesideTheRoadIsNoFault) {
  Sight sight;
  sight.moves = true;
  sight.drive.world = test::plain();
  scan::Scan scan = sight.drive.next();
  std::erase_if(scan.points, [](const scan::LidarPoint& p) { return std::abs(p.position.y()) > 4; });
  for (int i = 0; i < 3 * kSoon; ++i) sight.ground.check(scan, true);
  EXPECT_THAT(sight.faults(), IsEmpty());
}

TEST(GroundInSight, AnAlleyShowsItAheadAndBehind) {
  Sight sight;
  sight.drive.world = test::plain();
  for (const double side : {-1.0, 1.0})
    sight.drive.world.boxes.push_back({{-60, side < 0 ? -2.5 : 1.5, 0}, {60, side < 0 ? -1.5 : 2.5, 10}});
  sight.moves = true;
  sight.check(10 * kSoon);
  EXPECT_THAT(sight.faults(), IsEmpty());
}

/// Nothing is to be seen there, and nothing is wrong.
TEST(GroundInSight, OfAHallAndATrafficJamNothingIsSaid) {
  Sight sight;
  sight.drive.world = test::plain();
  for (const double side : {-1.0, 1.0}) {
    sight.drive.world.boxes.push_back({{-5, side < 0 ? -5.2 : 5.0, 0}, {5, side < 0 ? -5.0 : 5.2, 3}});
    sight.drive.world.boxes.push_back({{side < 0 ? -5.2 : 5.0, -5, 0}, {side < 0 ? -5.0 : 5.2, 5, 3}});
  }
  sight.check(10 * kSoon);
  EXPECT_THAT(sight.faults(), IsEmpty());
  EXPECT_EQ(sight.ground.share(), 1.0);
}

TEST(GroundInSight, RainThatTakesMostReturnsIsNoFault) {
  Sight sight;
  scan::Scan scan = sight.drive.next();
  std::uint64_t n = 0;
  std::erase_if(scan.points, [&](const scan::LidarPoint&) { return test::chance(++n) < 0.6; });
  for (int i = 0; i < 3 * kSoon; ++i) sight.ground.check(scan, true);
  EXPECT_THAT(sight.faults(), IsEmpty());
  EXPECT_GT(sight.ground.share(), 0.9);
}

TEST(GroundInSight, SlopesShowTheirGround) {
  for (const double slope : {-0.05, 0.05}) {  // the vehicle is level, and the street ahead rises or falls
    Sight sight;
    const scan::Scan scan = [&] {
      sight.drive.world = test::plain();
      scan::Scan s = sight.drive.next();
      for (scan::LidarPoint& point : s.points) {
        if (point.position.x() > 3) point.position.z() += static_cast<float>(slope) * (point.position.x() - 3);
      }
      return s;
    }();
    for (int i = 0; i < 2 * kSoon; ++i) sight.ground.check(scan, true);
    EXPECT_GT(sight.ground.share(), 0.5) << slope;
    EXPECT_GT(sight.ground.share_ahead(), 0.5) << slope;
    EXPECT_THAT(sight.faults(), IsEmpty()) << slope;
  }
}

TEST(GroundInSight, ALowLidarSeesItToo) {
  for (const double height : {0.6, 0.75, 0.9, 2.5}) {
    Sight sight;
    sight.drive.T_base_lidar.translation().z() = height;
    sight.ground = GroundInSight(sight.drive.T_base_lidar);
    sight.check(2 * kSoon);
    EXPECT_GT(sight.ground.share(), 0.9) << height;
  }
  Sight below;
  below.drive.T_base_lidar.translation().z() = 0.3;
  below.ground = GroundInSight(below.drive.T_base_lidar);
  below.check(2 * kSoon, 0.0);
  EXPECT_THAT(below.faults(), IsEmpty()) << "nothing is said";
}

TEST(GroundInSight, WhatIsNoMeasurementDoesNoHarm) {
  Sight sight;
  scan::Scan scan = sight.drive.next();
  for (scan::LidarPoint& point : scan.points) point.position.setConstant(point.ring % 2 == 0 ? NAN : INFINITY);
  for (int i = 0; i < 2 * kSoon; ++i) sight.ground.check(scan, false);
  for (int i = 0; i < 2 * kSoon; ++i) sight.ground.check(scan::Scan{}, true);
  EXPECT_THAT(sight.faults(), IsEmpty());
}

}  // namespace
}  // namespace curbstone::mapper::returns
