#include "services/mapper/returns/laser_elevations.hpp"

#include <gmock/gmock.h>

#include <numbers>

#include "tests/services/mapper/detection_scans.hpp"

namespace curbstone::mapper::returns {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kDegree = std::numbers::pi / 180;

class LaserElevationsTest : public ::testing::Test {
 protected:
  using Change = std::function<void(scan::Scan&)>;
  void check(int scans, const Change& change, bool moved = false) {
    for (int i = 0; i < scans; ++i) {
      scan_ = drive_.next();
      change(scan_);
      lasers_.check(scan_, moved);
    }
  }
  std::vector<int> wrong() const {
    std::vector<int> rings;
    for (std::size_t ring = 0; ring < LaserElevations::kLasers; ++ring) {
      if (lasers_.is_wrong(ring)) rings.push_back(static_cast<int>(ring));
    }
    return rings;
  }
  static Change raised(int ring, double degrees) {
    return [=](scan::Scan& scan) { test::raise(scan, ring, degrees); };
  }

  test::DetectionScans drive_;
  scan::Scan scan_;
  LaserElevations lasers_;
};

TEST_F(LaserElevationsTest, LasersThatAreRightKeepTheirPoints) {
  check(100, [](scan::Scan&) {});
  EXPECT_THAT(wrong(), IsEmpty());
  std::vector<std::string> faults;
  lasers_.add_faults(faults);
  EXPECT_THAT(faults, IsEmpty());
}

TEST_F(LaserElevationsTest, OneThatIsWrongIsNamedAndWithheldAfterTwoSeconds) {
  check(LaserElevations::kLooks - 1, raised(3, 0.5));
  EXPECT_THAT(wrong(), IsEmpty()) << "not yet";
  check(1, raised(3, 0.5));
  ASSERT_THAT(wrong(), ElementsAre(3));
  EXPECT_NEAR(lasers_.error(3), 0.5 * kDegree, 0.03 * kDegree);
  const std::size_t before = scan_.points.size();
  lasers_.withhold(scan_);
  EXPECT_LT(scan_.points.size(), before);
  for (const scan::LidarPoint& point : scan_.points) ASSERT_NE(point.ring, 3);
  EXPECT_EQ(lasers_.counters()["withheld.laser"], static_cast<std::int64_t>(before - scan_.points.size()));
  std::vector<std::string> faults;
  lasers_.add_faults(faults);
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_THAT(faults[0], HasSubstr("laser 3 (0: the lowest) looks 0.5"));
}

TEST_F(LaserElevationsTest, TheLowestAndTheNextAreDistinguished) {
  check(50, raised(0, -0.6));
  EXPECT_THAT(wrong(), ElementsAre(0));
  lasers_ = {};
  check(50, raised(1, 0.6));
  EXPECT_THAT(wrong(), ElementsAre(1));
}

TEST_F(LaserElevationsTest, TwoAtOnceAreNotTakenForOthers) {
  check(50, [](scan::Scan& scan) {
    test::raise(scan, 1, 0.5);
    test::raise(scan, 4, -0.7);
  });
  EXPECT_THAT(wrong(), IsEmpty());
}

TEST_F(LaserElevationsTest, ATenthOfADegreeIsNoFault) {
  check(100, raised(2, 0.1));
  EXPECT_THAT(wrong(), IsEmpty());
}

TEST_F(LaserElevationsTest, OneThatIsRightAgainIsUsedAgain) {
  check(50, raised(2, 0.5));
  ASSERT_THAT(wrong(), ElementsAre(2));
  check(10, [](scan::Scan&) {});
  check(1, raised(2, 0.5));
  check(LaserElevations::kLooks - 1, [](scan::Scan&) {});
  EXPECT_THAT(wrong(), ElementsAre(2)) << "as many in a row must say so";
  check(1, [](scan::Scan&) {});
  EXPECT_THAT(wrong(), IsEmpty());
}

TEST_F(LaserElevationsTest, GroundThatIsNotEvenIsNoLaser) {
  drive_.world.boxes.push_back({{4.0, -9, 0}, {40, 8, 0.12}});   // behind a kerb across the street
  drive_.world.boxes.push_back({{-60, 2.5, 0}, {60, 8, 0.15}});  // pavements
  drive_.world.boxes.push_back({{-60, -9, 0}, {60, -2.5, 0.15}});
  check(100, [](scan::Scan&) {});
  EXPECT_THAT(wrong(), IsEmpty());
}

/// What all see from a hilltop, or from the bottom of a bowl.
TEST_F(LaserElevationsTest, CurvedGroundIsNoLaser) {
  for (const double curvature : {1.0 / 60, -1.0 / 60}) {
    check(60, [&](scan::Scan& scan) {
      for (scan::LidarPoint& point : scan.points) {
        const float level = point.position.head<2>().norm();
        if (point.ring < 6) point.position.z() += static_cast<float>(curvature / 2) * level * level;
      }
    });
    EXPECT_THAT(wrong(), IsEmpty()) << curvature;
  }
}

TEST_F(LaserElevationsTest, ALeaningLidarIsNoLaser) {
  drive_.T_base_lidar = test::pose(0, 0, 1.73, 0.05, -0.08, 1.0);
  check(60, [](scan::Scan&) {});
  EXPECT_THAT(wrong(), IsEmpty());
  check(60, raised(2, 0.5));
  EXPECT_THAT(wrong(), ElementsAre(2));
}

TEST_F(LaserElevationsTest, WhatIsNoMeasurementIsNotLookedAt) {
  check(60, [](scan::Scan& scan) {
    for (std::size_t i = 0; i < scan.points.size(); i += 3) {
      scan.points[i].ring = static_cast<std::uint8_t>(i);
      scan.points[i].position.setConstant(i % 2 == 0 ? NAN : -1e30F);
    }
  });
  EXPECT_THAT(wrong(), IsEmpty());
  check(60, [](scan::Scan& scan) { scan.points.clear(); });
  EXPECT_THAT(wrong(), IsEmpty());
}

}  // namespace
}  // namespace curbstone::mapper::returns
