#include "drivers/encoder/wheel_counter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <vector>

namespace curbstone::encoder {
namespace {

constexpr double kRadians = 2 * std::numbers::pi / 4096;

/// Of a vehicle that drives: three samples, up to `at`, of counts that grow by `step` in a period of 0.01 s.
WheelCounter driving(WheelCounter::Raw at, int step) {
  WheelCounter odometer({});
  for (const int before : {2, 1, 0}) odometer.update({at[0] - before * step, at[1] + before * step}, 0.01);
  return odometer;
}

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

TEST(WheelCounterTest, AFirstStepOfWhichOneWheelMayBeDamagedWaitsForTheNext) {
  for (const int damaged : {0, 1, 2, 3}) {
    WheelCounter odometer({});
    std::vector<std::int64_t> left;
    for (int i = 0; i < 6; ++i) {
      const auto sample = odometer.update({100 * i + (i == damaged ? 256 : 0), -60 * i}, i == 0 ? 0 : 0.01);
      if (sample) left.push_back(sample->counts[0] - 100 * i);
    }
    ASSERT_GE(left.size(), 2U) << damaged;
    for (const std::int64_t error : left) EXPECT_EQ(error, 0) << damaged;
    EXPECT_GE(odometer.counters()["refused.outlier"], 1);
  }
}

TEST(WheelCounterTest, AFirstStepThatCannotBeIsNotConfirmedByTheNext) {
  WheelCounter odometer({});
  odometer.update({0, 0}, 0);
  EXPECT_FALSE(odometer.update({5'000'000, 0}, 0.4));
  EXPECT_FALSE(odometer.update({5'000'010, 0}, 0.00001));
  const auto sample = odometer.update({5'000'010, 0}, 0.01);
  ASSERT_TRUE(sample);
  EXPECT_LT(std::abs(sample->speed[0]), 150);
}

TEST(WheelCounterTest, UnwrapsInBothDirections) {
  WheelCounter odometer({});
  odometer.update({0x7FFFFFF0, -0x7FFFFFF0}, 0);
  EXPECT_EQ(odometer.update({-0x7FFFFFF0, 0x7FFFFFF0}, 0.1)->counts[0], 32);
  EXPECT_EQ(odometer.update({0x7FFFFFF0, -0x7FFFFFF0}, 0.1)->counts[1], 0);
}

TEST(WheelCounterTest, ASmallWheelOfAFastVehicleIsBelieved) {
  WheelCounter odometer({});
  const int step = 800;  // 123 rad/s: 9.8 m/s at 0.08 m
  for (int i = 0; i < 2; ++i) odometer.update({step * i, -step * i}, 0.01);
  for (int i = 2; i <= 100; ++i) ASSERT_TRUE(odometer.update({step * i, -step * i}, 0.01)) << i;
  EXPECT_EQ(odometer.counters()["refused.jump"], 0);
}

TEST(WheelCounterTest, AJumpIsRefusedOnceAndBelievedWhenItStays) {
  WheelCounter odometer = driving({100, -100}, 100);
  EXPECT_FALSE(odometer.update({1 << 30, -200}, 0.01));
  EXPECT_EQ(odometer.update({300, -300}, 0.01)->counts[0], 400);
  EXPECT_EQ(odometer.counters()["refused.jump"], 1);
  EXPECT_FALSE(odometer.update({5'000'000, -400}, 0.01));
  EXPECT_FALSE(odometer.update({5'000'100, -500}, 0.01));
  EXPECT_EQ(odometer.update({5'000'200, -600}, 0.01)->counts[0], 400);  // from here on anew
  EXPECT_EQ(odometer.update({5'000'300, -700}, 0.01)->counts[0], 500);
  EXPECT_EQ(odometer.counters()["counts_restarted"], 1);
}

/// How far a drive had gone, rad, how fast its wheels turn, rad/s, and for how long it says nothing, s.
class CountsThatBeginAtZero : public ::testing::TestWithParam<std::tuple<double, double, double>> {
 protected:
  static WheelCounter::Raw counts(double angle) {
    const auto count = static_cast<std::int32_t>(std::floor(angle / kRadians));
    return {count, -count};
  }
};

TEST_P(CountsThatBeginAtZero, AreNoWayBack) {
  const auto [travelled, speed, silence] = GetParam();
  for (const double period : {0.01, 0.02}) {
    WheelCounter odometer({});
    for (const int before : {2, 1, 0}) odometer.update(counts(travelled - speed * period * before), period);
    double angle = 0, since = silence;
    double least = 0, fastest = 0;
    for (int i = 0; i < 50; ++i) {
      angle += speed * (since + period);
      const auto sample = odometer.update(counts(angle - speed * (silence + period)), since + period);
      since = 0;
      if (!sample) continue;
      least = std::min(least, sample->angle[0]);
      fastest = std::max(fastest, std::abs(sample->speed[0]));
    }
    EXPECT_EQ(odometer.counters()["counts_restarted"], 1) << period;
    EXPECT_EQ(least, 0) << period;
    EXPECT_LT(fastest, speed + 1) << period;
  }
}
INSTANTIATE_TEST_SUITE_P(Drives, CountsThatBeginAtZero,
                         ::testing::Combine(::testing::Values(5.0, 12.0, 30.0), ::testing::Values(0.0, 2.0, 10.0),
                                            ::testing::Values(0.0, 0.1, 0.4)));

TEST(WheelCounterTest, OneReadingOfZeroCostsItself) {
  WheelCounter odometer({});
  odometer.update({800, -800}, 0);
  odometer.update({800, -800}, 0.02);
  EXPECT_FALSE(odometer.update({0, 0}, 0.02));
  const auto sample = odometer.update({810, -810}, 0.02);
  ASSERT_TRUE(sample);
  EXPECT_EQ(sample->counts[0], 10);
  EXPECT_EQ(odometer.counters()["counts_restarted"], 0);
}

TEST(WheelCounterTest, AWayBackThroughZeroIsOne) {
  WheelCounter odometer({});
  for (int count : {1010, 1000}) odometer.update({count, -count}, 0.02);
  for (int count = 990; count > -1000; count -= 10) ASSERT_TRUE(odometer.update({count, -count}, 0.02)) << count;
  odometer.update({-600, 600}, 0.1);  // it turns at once
  for (int count = -500; count < 1000; count += 100) ASSERT_TRUE(odometer.update({count, -count}, 0.1)) << count;
}

TEST(WheelCounterTest, CountsThatStandStillAtSpeedAreOldAndTheirDistanceIsInTheNextSample) {
  WheelCounter odometer = driving({100, -100}, 100);
  for (int i = 0; i < 9; ++i) EXPECT_FALSE(odometer.update({100, -100}, 0.01));
  EXPECT_STREQ(odometer.refusal(), "refused.old_counts");
  const auto sample = odometer.update({1100, -1100}, 0.01);
  ASSERT_TRUE(sample);
  EXPECT_EQ(sample->counts[0], 1200);
  EXPECT_DOUBLE_EQ(sample->speed[0], 100 * kRadians / 0.01);
  EXPECT_EQ(odometer.counters()["refused.old_counts"], 9);
  EXPECT_EQ(odometer.counters()["refused.jump"], 0);
}

TEST(WheelCounterTest, WheelsThatMayHaveStoppedHaveStopped) {
  WheelCounter odometer = driving({100, -100}, 100);  // 15.3 rad/s: 0.26 s of hard braking
  int refused = 0;
  while (!odometer.update({100, -100}, 0.01)) ++refused;
  EXPECT_EQ(refused, 26);
  EXPECT_TRUE(odometer.update({100, -100}, 0.01));
  for (int i = 0; i < 2; ++i) odometer.update({105, -105}, 0.01);
  EXPECT_TRUE(odometer.update({105, -105}, 0.01)) << "slowly they stop at once";
}

/// As of two controllers, each with a cycle of its own.
TEST(WheelCounterTest, CountsThatAreRenewedByTurnsAreTakenTogether) {
  WheelCounter odometer = driving({100, -100}, 50);
  for (int i = 2; i < 100; i += 2) {
    EXPECT_FALSE(odometer.update({50 * i, -50 * (i + 2)}, 0.01));
    const auto sample = odometer.update({50 * (i + 2), -50 * (i + 2)}, 0.01);
    ASSERT_TRUE(sample);
    for (const double speed : sample->speed) EXPECT_NEAR(speed, 50 * kRadians / 0.01, 1e-9);
  }
}

TEST(WheelCounterTest, TheCountsTellHowManyPeriodsHavePassed) {
  WheelCounter odometer = driving({100, -100}, 100);
  EXPECT_EQ(odometer.likely_periods({201, -199}, 1, 4, 0.01), 1);
  EXPECT_EQ(odometer.likely_periods({299, -303}, 1, 4, 0.01), 2);
  EXPECT_EQ(odometer.likely_periods({400, -400}, 1, 4, 0.01), 3);
  EXPECT_EQ(odometer.likely_periods({500, -500}, 1, 2, 0.01), std::nullopt) << "neither of both";
}

TEST(WheelCounterTest, PeriodsOfRefusedSamplesAreNoneOfTheNextOnes) {
  WheelCounter odometer = driving({100, -100}, 100);
  EXPECT_FALSE(odometer.update({1 << 30, -200}, 0.01));
  odometer.skip(0.01);
  EXPECT_EQ(odometer.likely_periods({400, -400}, 1, 2, 0.01), 1);
  EXPECT_EQ(odometer.likely_periods({500, -500}, 1, 2, 0.01), 2);
}

TEST(WheelCounterTest, SlowWheelsAreNoEvidence) {
  WheelCounter odometer({});
  odometer.update({0, 0}, 0);
  odometer.update({2, -2}, 0.01);
  EXPECT_EQ(odometer.likely_periods({8, -8}, 1, 4, 0.01), std::nullopt);
  EXPECT_FALSE(odometer.turns_fast(0.01));
}

TEST(WheelCounterTest, CountsThatAnAccelerationExplainsAsWellAreNoEvidence) {
  WheelCounter odometer = driving({20, -20}, 20);
  EXPECT_EQ(odometer.likely_periods({80, -80}, 1, 4, 0.01), std::nullopt);
}

}  // namespace
}  // namespace curbstone::encoder
