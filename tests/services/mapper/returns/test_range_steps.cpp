#include "services/mapper/returns/range_steps.hpp"

#include <gmock/gmock.h>

#include "tests/services/mapper/detection_scans.hpp"

namespace curbstone::mapper::returns {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

class RangeStepsTest : public ::testing::Test {
 protected:
  RangeStepsTest() { drive_.trajectory = test::driving; }
  /// Ranges in steps of `step` m, and `offset` m more per laser; coordinates in steps of `rounding` m.
  void check(int scans, float step, float offset = 0, float rounding = 0) {
    for (int i = 0; i < scans; ++i) {
      scan::Scan scan = drive_.next();
      for (scan::LidarPoint& point : scan.points) {
        const float range = point.position.norm();
        if (step > 0)
          point.position *= (std::round(range / step) * step + offset * static_cast<float>(point.ring)) / range;
        if (rounding > 0) point.position = (point.position / rounding).array().round() * rounding;
      }
      steps_.check(scan);
    }
  }
  std::vector<std::string> faults() const {
    std::vector<std::string> faults;
    steps_.add_faults(faults);
    return faults;
  }
  test::DetectionScans drive_;
  RangeSteps steps_;
};

constexpr int kScans = RangeSteps::kLooks * RangeSteps::kEvery;

TEST_F(RangeStepsTest, CoarseStepsAreNamedUntilTheyEnd) {
  for (const float step : {0.05F, 0.08F, 0.10F, 0.125F, 0.20F, 0.30F, 0.50F}) {
    steps_ = {};
    check(kScans, step);
    ASSERT_TRUE(steps_.step()) << step;
    EXPECT_NEAR(*steps_.step(), step, 0.02 * static_cast<double>(step));
    EXPECT_EQ(steps_.counters()["faults.lidar.range_steps"], 1);
  }
  EXPECT_THAT(faults().at(0), HasSubstr("in steps of 50.0 cm"));
  check(kScans, 0);
  EXPECT_THAT(faults(), IsEmpty());
}

TEST_F(RangeStepsTest, OffsetsOfTheLasersAndRoundedCoordinatesDoNotHideThem) {
  check(kScans, 0.08F, 0.013F, 0.002F);
  EXPECT_TRUE(steps_.step());
}

TEST_F(RangeStepsTest, TheStepsOfSoundDevicesAreNoFault) {
  for (const float step : {0.0F, 0.002F, 0.005F, 0.01F, 0.02F, 0.04F}) {
    check(2 * kScans, step);
    EXPECT_THAT(faults(), IsEmpty()) << step;
    check(2 * kScans, step, 0.013F, 0.001F);
    EXPECT_THAT(faults(), IsEmpty()) << step;
  }
}

TEST_F(RangeStepsTest, NeitherATunnelNorAPlainHasSteps) {
  for (const auto& world : {test::tunnel(), test::plain()}) {
    drive_.world = world;
    for (const double noise : {0.0, 0.01}) {
      drive_.world.noise = noise;
      check(2 * kScans, 0);
      EXPECT_THAT(faults(), IsEmpty());
    }
  }
}

TEST_F(RangeStepsTest, WhatIsNoMeasurementDoesNoHarm) {
  scan::Scan scan = drive_.next();
  for (scan::LidarPoint& point : scan.points) point.position.setConstant(point.ring % 2 == 0 ? NAN : INFINITY);
  for (int i = 0; i < 2 * kScans; ++i) steps_.check(scan);
  for (int i = 0; i < 2 * kScans; ++i) steps_.check({});
  EXPECT_THAT(faults(), IsEmpty());
}

}  // namespace
}  // namespace curbstone::mapper::returns
