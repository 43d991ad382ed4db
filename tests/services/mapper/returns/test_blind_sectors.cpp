#include "services/mapper/returns/blind_sectors.hpp"

#include <gmock/gmock.h>

#include "tests/services/mapper/detection_scans.hpp"

namespace curbstone::mapper::returns {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class BlindSectorsTest : public ::testing::Test {
 protected:
  BlindSectorsTest() : scan_(drive_.next()) {}
  /// `from`..`to` deg to the left return nothing, or mud at `mud` m.
  void check(int scans, double from = 0, double to = 0, float mud = 0) {
    scan::Scan scan = scan_;
    scan.points.clear();
    for (scan::LidarPoint point : scan_.points) {
      const auto degrees =
          static_cast<double>(std::atan2(point.position.y(), point.position.x())) * 180 / 3.14159265358979;
      if (degrees > from && degrees < to) {
        if (mud == 0) continue;
        point.position *= mud / point.position.norm();
      }
      scan.points.push_back(point);
    }
    for (int i = 0; i < scans; ++i) sectors_.check(scan);
  }
  std::vector<std::string> faults() const {
    std::vector<std::string> faults;
    sectors_.add_faults(faults);
    return faults;
  }
  test::DetectionScans drive_;
  scan::Scan scan_;
  BlindSectors sectors_;
};

TEST_F(BlindSectorsTest, MudIsReportedUntilTheWindowIsClean) {
  for (const float mud : {0.0F, 0.5F}) {
    check(BlindSectors::kSteady);
    EXPECT_THAT(faults(), IsEmpty());
    check(BlindSectors::kBlind - 1, 19.8, 60.2, mud);
    EXPECT_THAT(sectors_.blind(), IsEmpty()) << "not yet";
    check(1, 19.8, 60.2, mud);
    EXPECT_THAT(sectors_.blind(), ElementsAre(25, 35, 45, 55));
    ASSERT_EQ(faults().size(), 1U);
    EXPECT_THAT(faults()[0], HasSubstr("from 40 deg of its round, from 20 to 60 deg to the left"));
    check(1);
    EXPECT_THAT(sectors_.blind(), IsEmpty());
  }
  EXPECT_EQ(sectors_.counters()["faults.blind_sector"], 8);
}

TEST_F(BlindSectorsTest, ArcsThatAreApartAreNamedEach) {
  check(BlindSectors::kSteady);
  for (int i = 0; i < BlindSectors::kBlind; ++i) {
    scan::Scan scan = scan_;
    std::erase_if(scan.points, [](const scan::LidarPoint& point) {
      const float degrees = std::abs(std::atan2(point.position.y(), point.position.x())) * 57.29578F;
      return degrees > 149.8F || (degrees > 39.8F && degrees < 60.2F && point.position.y() < 0);
    });
    sectors_.check(scan);
  }
  EXPECT_THAT(faults().at(0), HasSubstr("from 80 deg of its round, from 150 to -150, from -60 to -40 deg to the left"));
}

TEST_F(BlindSectorsTest, WhatTheVehicleHidesFromTheStartIsNoFault) {
  check(500, 150, 180);
  EXPECT_THAT(sectors_.blind(), IsEmpty());
}

TEST_F(BlindSectorsTest, SomethingThatPassesIsNoFault) {
  check(BlindSectors::kSteady);
  for (int i = 0; i < 20; ++i) {
    check(BlindSectors::kBlind / 2, -60, -20);
    check(2);
  }
  EXPECT_THAT(sectors_.blind(), IsEmpty());
}

TEST_F(BlindSectorsTest, ARevolutionOfWhichMostIsMissingSaysNothing) {
  check(BlindSectors::kSteady);
  check(500, -90, 179);
  scan::Scan none;
  for (int i = 0; i < 100; ++i) sectors_.check(none);
  EXPECT_THAT(sectors_.blind(), IsEmpty());
}

TEST_F(BlindSectorsTest, WhatIsNoMeasurementDoesNoHarm) {
  for (scan::LidarPoint& point : scan_.points) point.position.setConstant(point.ring % 2 == 0 ? NAN : INFINITY);
  check(200);
  EXPECT_THAT(sectors_.blind(), IsEmpty());
}

}  // namespace
}  // namespace curbstone::mapper::returns
