#include "services/mapper/returns/stray_returns.hpp"

#include <gmock/gmock.h>

#include "tests/services/mapper/detection_scans.hpp"

namespace curbstone::mapper::returns {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::uint8_t kDrop = 255;  // intensity by which the test knows them

/// `share` of the shots end at a drop, 0.5 to 10 m away.
void rain(scan::Scan& scan, double share) {
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const std::uint64_t dice = static_cast<std::uint64_t>(scan.number) * 100'000 + i;
    const float range = scan.points[i].position.norm();
    const auto drop = static_cast<float>(0.5 + 9.5 * test::chance(dice * 2));
    if (test::chance(dice * 2 + 1) >= share || drop > range - 1) continue;
    scan.points[i].position *= drop / range;
    scan.points[i].intensity = kDrop;
  }
}

class StrayReturnsTest : public ::testing::Test {
 protected:
  StrayReturnsTest() { drive_.trajectory = test::driving; }
  struct Left {
    double drops = 0, others = 0;  // shares
  };
  Left pass(int scans, double share) {
    double drops = 0, others = 0, drops_left = 0, others_left = 0;
    for (int i = 0; i < scans; ++i) {
      scan::Scan scan = drive_.next();
      rain(scan, share);
      const auto count = [&](double& d, double& o) {
        for (const scan::LidarPoint& point : scan.points) (point.intensity == kDrop ? d : o) += 1;
      };
      count(drops, others);
      strays_.filter(scan);
      count(drops_left, others_left);
    }
    return {drops > 0 ? drops_left / drops : 0, others_left / others};
  }

  test::DetectionScans drive_;
  StrayReturns strays_;
};

TEST_F(StrayReturnsTest, InDryAirEveryPointStays) {
  EXPECT_EQ(pass(60, 0).others, 1.0);
  EXPECT_FALSE(strays_.filters());
  EXPECT_LT(strays_.share(), StrayReturns::kFew);
}

TEST_F(StrayReturnsTest, DropsAreLeftOutWhileItRains) {
  EXPECT_EQ(pass(StrayReturns::kLooks - 1, 0.03).drops, 1.0) << "not yet";
  const Left left = pass(40, 0.03);
  EXPECT_TRUE(strays_.filters());
  EXPECT_LT(left.drops, 0.1);
  EXPECT_GT(left.others, 0.98);
  EXPECT_GT(strays_.counters()["withheld.stray"], 1000);
  std::vector<std::string> faults;
  strays_.add_faults(faults);
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_THAT(faults[0], HasSubstr("stand alone in the air"));
  pass(StrayReturns::kLooks, 0);
  EXPECT_FALSE(strays_.filters()) << "it is over";
  EXPECT_EQ(pass(5, 0).others, 1.0);
  faults.clear();
  strays_.add_faults(faults);
  EXPECT_THAT(faults, IsEmpty());
}

TEST_F(StrayReturnsTest, HeavySnowTakesLittleElseWithIt) {
  pass(StrayReturns::kLooks, 0.15);
  const Left left = pass(20, 0.15);
  EXPECT_LT(left.drops, 0.25);
  EXPECT_GT(left.others, 0.95);
}

TEST_F(StrayReturnsTest, GustsAreNoRain) {
  for (int i = 0; i < 10; ++i) {
    pass(StrayReturns::kLooks / 2, 0.05);
    pass(1, 0);
  }
  EXPECT_FALSE(strays_.filters());
}

TEST_F(StrayReturnsTest, WhatIsNoMeasurementDoesNoHarm) {
  for (int i = 0; i < 60; ++i) {
    scan::Scan scan = drive_.next();
    for (std::size_t k = 0; k < scan.points.size(); k += 2) {
      scan.points[k].position.setConstant(k % 4 == 0 ? NAN : 1e30F);
      scan.points[k].time = k % 3 == 0 ? NAN : -1e9F;
      scan.points[k].ring = static_cast<std::uint8_t>(k);
    }
    strays_.filter(scan);
    scan.points.clear();
    strays_.filter(scan);
  }
}

}  // namespace
}  // namespace curbstone::mapper::returns
