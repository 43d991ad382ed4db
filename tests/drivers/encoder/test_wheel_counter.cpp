#include "drivers/encoder/wheel_counter.hpp"

#include <gtest/gtest.h>

#include <numbers>

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

TEST(WheelCounterTest, ASmallWheelOfAFastVehicleIsBelieved) {
  WheelCounter odometer({});
  const int step = 800;  // 123 rad/s: 9.8 m/s at 0.08 m
  odometer.update({0, 0}, 0);
  for (int i = 1; i <= 100; ++i) ASSERT_TRUE(odometer.update({step * i, -step * i}, 0.01)) << i;
  EXPECT_EQ(odometer.counters()["refused.jump"], 0);
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

TEST(WheelCounterTest, CountsThatStandStillAtSpeedAreOldAndTheirDistanceIsInTheNextSample) {
  WheelCounter odometer({});
  odometer.update({0, 0}, 0);
  odometer.update({100, -100}, 0.01);
  for (int i = 0; i < 9; ++i) EXPECT_FALSE(odometer.update({100, -100}, 0.01));
  EXPECT_STREQ(odometer.refusal(), "refused.old_counts");
  const auto sample = odometer.update({1100, -1100}, 0.01);
  ASSERT_TRUE(sample);
  EXPECT_EQ(sample->counts[0], 1100);
  EXPECT_DOUBLE_EQ(sample->speed[0], 100 * kRadians / 0.01);
  EXPECT_EQ(odometer.counters()["refused.old_counts"], 9);
  EXPECT_EQ(odometer.counters()["refused.jump"], 0);
}

TEST(WheelCounterTest, WheelsThatMayHaveStoppedHaveStopped) {
  WheelCounter odometer({});
  odometer.update({0, 0}, 0);
  odometer.update({100, -100}, 0.01);  // 15.3 rad/s: 0.26 s of hard braking
  int refused = 0;
  while (!odometer.update({100, -100}, 0.01)) ++refused;
  EXPECT_EQ(refused, 25);
  EXPECT_TRUE(odometer.update({100, -100}, 0.01));
  odometer.update({105, -105}, 0.01);
  EXPECT_TRUE(odometer.update({105, -105}, 0.01)) << "slowly they stop at once";
}

/// As of two controllers, each with a cycle of its own.
TEST(WheelCounterTest, CountsThatAreRenewedByTurnsAreTakenTogether) {
  WheelCounter odometer({});
  odometer.update({0, 0}, 0);
  odometer.update({100, -100}, 0.01);
  for (int i = 2; i < 100; i += 2) {
    EXPECT_FALSE(odometer.update({50 * i, -50 * (i + 2)}, 0.01));
    const auto sample = odometer.update({50 * (i + 2), -50 * (i + 2)}, 0.01);
    ASSERT_TRUE(sample);
    for (const double speed : sample->speed) EXPECT_NEAR(speed, 50 * kRadians / 0.01, 1e-9);
  }
}

TEST(WheelCounterTest, TheCountsTellHowManyPeriodsHavePassed) {
  WheelCounter odometer({});
  odometer.update({0, 0}, 0);
  odometer.update({100, -100}, 0.01);
  EXPECT_EQ(odometer.likely_periods({201, -199}, 1, 4, 0.01), 1);
  EXPECT_EQ(odometer.likely_periods({299, -303}, 1, 4, 0.01), 2);
  EXPECT_EQ(odometer.likely_periods({400, -400}, 1, 4, 0.01), 3);
  EXPECT_EQ(odometer.likely_periods({500, -500}, 1, 2, 0.01), std::nullopt) << "neither of both";
}

TEST(WheelCounterTest, PeriodsOfRefusedSamplesAreNoneOfTheNextOnes) {
  WheelCounter odometer({});
  odometer.update({0, 0}, 0);
  odometer.update({100, -100}, 0.01);
  EXPECT_FALSE(odometer.update({1 << 30, -200}, 0.01));
  odometer.pass(0.01);
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
  WheelCounter odometer({});
  odometer.update({0, 0}, 0);
  odometer.update({20, -20}, 0.01);
  EXPECT_EQ(odometer.likely_periods({80, -80}, 1, 4, 0.01), std::nullopt);
}

}  // namespace
}  // namespace curbstone::encoder
