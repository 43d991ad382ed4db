#include "drivers/encoder/wheel_counter.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "drivers/encoder/period_clock.hpp"

namespace curbstone::encoder {
namespace {

constexpr double kRadians = 2 * std::numbers::pi / 4096;

TEST(WheelCounterTest, BothWheelsCountForwardWhenTheVehicleDrivesForward) {
  WheelCounter odometer({});
  odometer.update({1000, -500}, 0);
  const auto sample = odometer.update({1100, -600}, 0.01);
  ASSERT_TRUE(sample);
  for (std::size_t side = 0; side < 2; ++side) {
    EXPECT_EQ(sample->counts[side], 100);
    EXPECT_DOUBLE_EQ(sample->angle[side], 100 * kRadians);
    EXPECT_DOUBLE_EQ(sample->speed[side], 100 * kRadians / 0.01);
  }
}

TEST(WheelCounterTest, UnwrapsInBothDirections) {
  WheelCounter odometer({});
  odometer.update({0x7FFFFFF0, -0x7FFFFFF0}, 0);
  EXPECT_EQ(odometer.update({-0x7FFFFFF0, 0x7FFFFFF0}, 0.01)->counts[0], 32);
  EXPECT_EQ(odometer.update({0x7FFFFFF0, -0x7FFFFFF0}, 0.01)->counts[1], 0);
}

TEST(WheelCounterTest, AJumpIsRefusedOnceAndBelievedWhenItStays) {
  WheelCounter odometer({});
  odometer.update({0, 0}, 0);
  odometer.update({100, -100}, 0.01);
  EXPECT_FALSE(odometer.update({1 << 30, -200}, 0.01));
  EXPECT_EQ(odometer.update({300, -300}, 0.01)->counts[0], 300);
  EXPECT_EQ(odometer.counters()["refused.jump"], 1);
  EXPECT_FALSE(odometer.update({5'000'000, -400}, 0.01));
  EXPECT_FALSE(odometer.update({5'000'100, -500}, 0.01));
  EXPECT_EQ(odometer.update({5'000'200, -600}, 0.01)->counts[0], 300);  // from here on anew
  EXPECT_EQ(odometer.update({5'000'300, -700}, 0.01)->counts[0], 400);
  EXPECT_EQ(odometer.counters()["counts_restarted"], 1);
}

TEST(WheelCounterTest, TheCountsTellHowManyPeriodsHavePassed) {
  WheelCounter odometer({});
  odometer.update({0, 0}, 0);
  odometer.update({100, -100}, 0.01);
  EXPECT_EQ(odometer.likely_periods({201, -199}, 4, 0.01), 1);
  EXPECT_EQ(odometer.likely_periods({299, -303}, 4, 0.01), 2);
  EXPECT_EQ(odometer.likely_periods({400, -400}, 4, 0.01), 3);
  EXPECT_EQ(odometer.likely_periods({500, -500}, 2, 0.01), 2);
}

TEST(WheelCounterTest, SlowWheelsAreNoEvidence) {
  WheelCounter odometer({});
  odometer.update({0, 0}, 0);
  odometer.update({2, -2}, 0.01);
  EXPECT_EQ(odometer.likely_periods({8, -8}, 4, 0.01), std::nullopt);
}

TEST(PeriodClockTest, StampsKeepThePeriodWhateverTheDelay) {
  PeriodClock clock(10'000);
  const auto late = [](int) -> std::optional<int> { return {}; };
  EXPECT_TRUE(clock.stamp(0, late).restarted);
  EXPECT_EQ(clock.stamp(10'000, late).utime, 10'000);
  EXPECT_EQ(clock.stamp(57'000, late).utime, 20'000);
  EXPECT_EQ(clock.stamp(57'000, late).utime, 30'000);
  EXPECT_EQ(clock.stamp(57'000, late).utime, 40'000);
  EXPECT_EQ(clock.stamp(58'000, late).utime, 50'000);
}

TEST(PeriodClockTest, ALateFirstSampleIsShownInHindsightToHaveBeenTakenEarlier) {
  PeriodClock clock(10'000);
  const auto late = [](int) -> std::optional<int> { return {}; };
  EXPECT_EQ(clock.stamp(25'000, late).utime, 25'000);  // taken at 0
  EXPECT_EQ(clock.stamp(25'000, late).earlier, 10'000);
  EXPECT_EQ(clock.stamp(25'000, late).earlier, 10'000);
  const auto punctual = clock.stamp(30'100, late);
  EXPECT_EQ(punctual.utime, 30'100);
  EXPECT_EQ(punctual.earlier, 4'900);
  EXPECT_EQ(clock.stamp(41'000, late).earlier, 0);
}

TEST(PeriodClockTest, LostSamplesAreSkippedOnEvidence) {
  PeriodClock clock(10'000);
  const auto lost = [](int most) { return most; };
  clock.stamp(0, lost);
  const auto stamp = clock.stamp(40'300, lost);
  EXPECT_EQ(stamp.steps, 4);
  EXPECT_EQ(stamp.utime, 40'000);
}

TEST(PeriodClockTest, LatenessThatNobodyMakesGoodWasALoss) {
  PeriodClock clock(10'000);
  const auto late = [](int) -> std::optional<int> { return {}; };
  int lost = 0;
  std::int64_t last = 0;
  for (int i = 0; i < 600; ++i) {
    if (i == 40 || i == 41) continue;
    const auto stamp = clock.stamp(i * 10'000, late);
    lost += stamp.lost_before;
    last = stamp.utime;
    if (i == 150) {
      EXPECT_EQ(last, 1'500'000);  // the stamps are right long before it is certain
    }
  }
  EXPECT_EQ(lost, 2);
  EXPECT_EQ(last, 5'990'000);
}

TEST(PeriodClockTest, AHostThatIsLateForASecondHasLostNothing) {
  for (const std::int64_t delay : {8'000, 12'000, 27'000}) {
    PeriodClock clock(10'000);
    std::int64_t last = 0;
    for (int i = 0; i < 1000; ++i) {
      const bool busy = i >= 200 && i < 320;
      const auto stamp = clock.stamp(i * 10'000 + (busy ? delay : 200), [](int) -> std::optional<int> { return {}; });
      EXPECT_EQ(stamp.steps, 1);
      EXPECT_EQ(stamp.lost_before, 0) << i;
      last = stamp.utime;
    }
    EXPECT_EQ(last, 9'990'200);
  }
}

TEST(PeriodClockTest, LatenessThatTheEvidenceExplainsIsTheHostsHoweverLongItLasts) {
  PeriodClock clock(10'000);
  for (int i = 0; i < 1000; ++i) {
    const auto stamp = clock.stamp(i * 10'000 + (i < 200 ? 200 : 9'800), [](int) { return 1; });
    EXPECT_EQ(stamp.steps, 1);
    EXPECT_EQ(stamp.lost_before, 0) << i;
  }
}

TEST(PeriodClockTest, WhatCameWhileTheHostSleptKeepsItsTime) {
  PeriodClock clock(10'000);
  for (int i = 0; i < 300; ++i) {
    const std::int64_t received = i >= 100 && i < 180 ? 1'800'000 : i * 10'000;
    EXPECT_EQ(clock.stamp(received, [](int) { return 1; }).utime, i * 10'000);
  }
}

TEST(PeriodClockTest, ASilenceOrAClockSetBackBeginsAnew) {
  PeriodClock clock(10'000);
  const auto late = [](int) -> std::optional<int> { return {}; };
  clock.stamp(0, late);
  EXPECT_EQ(clock.stamp(600'000, late).utime, 600'000);
  EXPECT_TRUE(clock.stamp(5'000, late).restarted);
  EXPECT_EQ(clock.stamp(15'000, late).utime, 15'000);
}

TEST(PeriodClockTest, APauseIsNotAnotherPeriod) {
  PeriodClock clock(10'000);
  std::int64_t last = 0;
  for (int i = 0; i < 300; ++i) {
    const std::int64_t received = i >= 46 && i < 64 ? 640'000 + i : i * 10'000;  // the end of the first block
    last = clock.stamp(received, [](int) -> std::optional<int> { return {}; }).utime;
    EXPECT_EQ(last, i * 10'000);
    EXPECT_EQ(clock.period(), 10'000);
  }
}

TEST(PeriodClockTest, AnotherPeriodIsNoticed) {
  PeriodClock clock(10'000);
  for (int i = 0; i < 200; ++i) clock.stamp(i * 20'000, [](int) { return 1; });
  EXPECT_EQ(clock.period(), 20'000);
  for (int i = 0; i < 200; ++i) clock.stamp(4'000'000 + i * 10'000, [](int) { return 1; });
  EXPECT_EQ(clock.period(), 10'000);
}

}  // namespace
}  // namespace curbstone::encoder
