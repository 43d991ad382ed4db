#include "services/ekf/inputs/imu_outlier_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace curbstone::ekf::inputs {
namespace {

/// A vehicle that sways and shakes, at 100 samples a second.
class ImuOutlierFilterTest : public ::testing::Test {
 protected:
  base::ImuSample next(double shaking = 0.1) {
    const double t = 0.01 * static_cast<double>(taken_++);
    base::ImuSample sample;
    sample.utime = std::llround(1e6 * t);
    sample.angular_rate << 0.1 * std::sin(7 * t), 0.1 * std::cos(5 * t), 0.4 * std::sin(t);
    sample.acceleration << shaking * normal_(engine_), shaking * normal_(engine_), 9.81 + shaking * normal_(engine_);
    return sample;
  }
  void settle(double shaking = 0.1) {
    for (int i = 0; i < 200; ++i) ASSERT_EQ(samples_.add(next(shaking)).size(), 1U);
  }
  ImuOutlierFilter samples_;

 private:
  int taken_ = 0;
  std::mt19937 engine_{3};
  std::normal_distribution<double> normal_;
};

TEST_F(ImuOutlierFilterTest, OfAVehicleThatDrivesAndShakesThereAreNone) {
  settle(3.0);
  EXPECT_EQ(samples_.refused(), 0);
}

TEST_F(ImuOutlierFilterTest, OneThatLeapsAndTheNextIsBackIsRefused) {
  settle();
  base::ImuSample bad = next();
  bad.angular_rate.z() += 0.8;
  EXPECT_TRUE(samples_.add(bad).empty());
  EXPECT_EQ(samples_.add(next()).size(), 1U);
  EXPECT_EQ(samples_.refused(), 1);
}

TEST_F(ImuOutlierFilterTest, SoAreTwoTogetherOfTheAccelerometer) {
  settle();
  for (const double leap : {-60.0, 45.0}) {
    base::ImuSample bad = next();
    bad.acceleration.x() += leap;
    EXPECT_TRUE(samples_.add(bad).empty());
  }
  EXPECT_EQ(samples_.add(next()).size(), 1U);
  EXPECT_EQ(samples_.refused(), 2);
}

TEST_F(ImuOutlierFilterTest, AJoltThatGoesOnIsLetThroughWhole) {
  settle();
  std::size_t passed = 0;
  for (int i = 0; i < 5; ++i) {
    base::ImuSample jolt = next();
    jolt.angular_rate.y() += 3.0;
    passed += samples_.add(jolt).size();
  }
  EXPECT_EQ(passed, 5U);
  for (int i = 0; i < 5; ++i) passed += samples_.add(next()).size();
  EXPECT_EQ(passed, 10U);
  EXPECT_EQ(samples_.refused(), 0);
}

TEST_F(ImuOutlierFilterTest, WhatIsUsualOnARoughTrackIsNoLeap) {
  settle();
  std::size_t passed = 0;
  for (int i = 0; i < 1000; ++i) passed += samples_.add(next(15.0)).size();
  EXPECT_GT(passed, 950U);
  const std::int64_t before = samples_.refused();
  for (int i = 0; i < 1000; ++i) samples_.add(next(15.0));
  EXPECT_EQ(samples_.refused(), before);
}

TEST_F(ImuOutlierFilterTest, OneOfAHundredIsRefusedForAsLongAsItTakes) {
  settle();
  std::int64_t bad = 0;
  for (int i = 0; i < 6000; ++i) {
    base::ImuSample sample = next();
    if (i % 100 == 50) {
      sample.angular_rate.z() += i % 200 == 50 ? 6.0 : -6.0;
      ++bad;
    }
    samples_.add(sample);
  }
  EXPECT_EQ(samples_.refused(), bad);
  EXPECT_NEAR(static_cast<double>(samples_.rejected_last_minute()), 60.0, 1.0);
}

TEST_F(ImuOutlierFilterTest, OneBeforeAGapAndALateOneAreNoMeasureOfEachOther) {
  settle();
  const base::ImuSample late = next();
  const base::ImuSample last = next();
  EXPECT_EQ(samples_.add(last).size(), 1U);
  ASSERT_EQ(samples_.add(late).size(), 1U);
  EXPECT_EQ(samples_.add(late).front().utime, late.utime);
  base::ImuSample after_gap = next();
  after_gap.utime += 500'000;
  after_gap.angular_rate.z() += 2.0;
  EXPECT_EQ(samples_.add(after_gap).size(), 1U);
  EXPECT_EQ(samples_.refused(), 0);
}

TEST_F(ImuOutlierFilterTest, AClockThatWasSetBackBeginsAnew) {
  settle();
  base::ImuSample earlier = next();
  earlier.utime -= 3'600'000'000;
  ASSERT_EQ(samples_.add(earlier).size(), 1U);
  base::ImuSample bad = earlier;
  bad.utime += 10'000;
  bad.angular_rate.x() += 5.0;
  EXPECT_TRUE(samples_.add(bad).empty());
}

}  // namespace
}  // namespace curbstone::ekf::inputs
