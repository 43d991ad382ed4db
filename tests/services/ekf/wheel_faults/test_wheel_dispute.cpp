#include "services/ekf/wheel_faults/wheel_dispute.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>

namespace curbstone::ekf::wheel_faults {
namespace {

using Finding = WheelDispute::Finding;

constexpr std::int64_t kSampling = 50'000;  // us
constexpr double kTrack = 0.6;              // m
constexpr double kPatience = 5.0;           // s
constexpr std::array<bool, 2> kBoth = {true, true};

/// Wheels and a filter that have come apart.
struct Dispute {
  explicit Dispute(const RecentSpeeds::Leap& leap = {}) : of({kPatience, kTrack}, 0, leap) {}
  void step(std::array<double, 2> speed, double expected, std::array<bool, 2> trusted = kBoth) {
    WheelObservation observation;
    observation.begin = now;
    observation.end = now += kSampling;
    observation.speed = speed;
    observation.expected = {expected, expected};
    of.add(observation, trusted);
  }
  void run(double seconds, std::array<double, 2> speed, double expected, std::array<bool, 2> trusted = kBoth) {
    for (int i = 0; i < static_cast<int>(seconds * 20 + 0.5); ++i) step(speed, expected, trusted);
  }

  std::int64_t now = 0;
  WheelDispute of;
};

TEST(WheelDisputeTest, OneMultipleInAllTheTimeIsTheWheelsFault) {
  for (const double k : {0.0, -1.0, 0.5, 2.0}) {
    Dispute dispute;
    dispute.run(2.5, {3 * k, 3 * k}, 3);
    dispute.run(2.7, {4 * k, 4 * k}, 4);
    EXPECT_EQ(dispute.of.finding(), Finding::kWheelsWrong) << k;
    EXPECT_NEAR(dispute.of.evidence(0).ratio(), k, 1e-9);
    EXPECT_NEAR(dispute.of.expected_speed(), 4, 1e-9);
  }
}

TEST(WheelDisputeTest, AMultipleThatChangesIsTheFiltersFault) {
  Dispute dispute;
  dispute.run(2.5, {0, 0}, 3);
  dispute.run(2.7, {1.8, 1.8}, 3);
  EXPECT_EQ(dispute.of.finding(), Finding::kFilterWrong);
}

TEST(WheelDisputeTest, WhatComesApartFirstIsNotCounted) {
  Dispute dispute;
  dispute.run(0.4, {9, -9}, 3);
  dispute.run(4.8, {0, 0}, 3);
  EXPECT_EQ(dispute.of.finding(), Finding::kWheelsWrong);
  EXPECT_NEAR(dispute.of.evidence(0).ratio(), 0, 1e-9);
}

TEST(WheelDisputeTest, AMultipleThatAWrongRadiusExplainsIsTheFiltersFault) {
  for (const double k : {0.8, 1.2}) {
    Dispute dispute;
    dispute.run(5.2, {3 * k, 3 * k}, 3);
    EXPECT_EQ(dispute.of.finding(), Finding::kFilterWrong) << k;
  }
}

TEST(WheelDisputeTest, ATurningWheelProvesNothingForOneThatIsNotTrusted) {
  Dispute dispute;
  dispute.run(5.2, {3 * 0.9, 0}, 3, {false, true});
  EXPECT_EQ(dispute.of.finding(), Finding::kWheelsWrong);
  EXPECT_NEAR(dispute.of.evidence(0).ratio(), 1, 1e-9) << "nothing was collected of it";
  EXPECT_NEAR(dispute.of.evidence(1).ratio(), 0, 1e-9);
}

TEST(WheelDisputeTest, AnImuThatLeaptIsTheFiltersFaultWhateverTheWheelsShow) {
  Dispute dispute({.wheels = 0.0, .imu = true});
  dispute.run(5.2, {0, 0}, 3);
  EXPECT_EQ(dispute.of.finding(), Finding::kFilterWrong);
}

/// At an even speed it looks like a multiple. At walking pace a leap by .25 m/s looks like wheels that are wrong by a
/// quarter.
TEST(WheelDisputeTest, ALeapOfTheImuByMostOfWhatTheyDifferByIsTheFiltersFault) {
  Dispute leapt({.offset = -0.2});
  leapt.run(5.2, {0.7, 0.7}, 0.95);
  EXPECT_EQ(leapt.of.finding(), Finding::kFilterWrong);
  Dispute one_wheel({.offset = -0.2});
  one_wheel.run(5.2, {0.0, 0.7}, 0.95, {false, true});
  EXPECT_EQ(one_wheel.of.finding(), Finding::kFilterWrong);
  Dispute other_way({.offset = 0.2});
  other_way.run(5.2, {0.7, 0.7}, 0.95);
  EXPECT_EQ(other_way.of.finding(), Finding::kWheelsWrong);
  Dispute half({.offset = -0.15});
  half.run(5.2, {0.35, 0.35}, 0.7);
  EXPECT_EQ(half.of.finding(), Finding::kWheelsWrong) << "as it speeds up, the wheels lag";
}

TEST(WheelDisputeTest, ALeapThatTakesSomeIntervalsIsKnownByThem) {
  Dispute dispute;
  dispute.step({0.7, 0.7}, 0.8);
  dispute.of.update_leap({.offset = -0.2});
  dispute.run(5.2, {0.7, 0.7}, 0.95);
  EXPECT_EQ(dispute.of.finding(), Finding::kFilterWrong);
  Dispute late;
  late.run(1.0, {0.7, 0.7}, 0.95);
  late.of.update_leap({.offset = -0.2});
  late.run(4.2, {0.7, 0.7}, 0.95);
  EXPECT_EQ(late.of.finding(), Finding::kWheelsWrong) << "it did not begin with it";
}

/// The wheels are off by what a drifting filter would be off by, and by a multiple too: only what follows tells.
TEST(WheelDisputeTest, WhereEitherExplainsItMoreIsAwaitedThreeTimes) {
  Dispute dispute;
  const auto drift = [&](double seconds) {  // from standstill
    for (int i = 0; i < static_cast<int>(seconds * 20 + 0.5); ++i) {
      const double speed = 0.5 * (1e-6 * static_cast<double>(dispute.now) + WheelDispute::kBefore);
      dispute.step({0, 0}, speed);
    }
  };
  drift(5.2);
  for (int patience = 0; patience < 2; ++patience) {
    ASSERT_EQ(dispute.of.finding(), Finding::kUndecided) << patience;
    dispute.of.extend();
    drift(5.0);
  }
  EXPECT_EQ(dispute.of.finding(), Finding::kFilterWrong);
}

TEST(WheelDisputeTest, AnEvenSpeedAfterTheSpeedingUpProvesTheWheelsWrong) {
  Dispute dispute;
  for (int i = 0; i < 104; ++i) dispute.step({0, 0}, 0.5 * (0.05 * i + WheelDispute::kBefore));
  ASSERT_EQ(dispute.of.finding(), Finding::kUndecided);
  dispute.of.extend();
  dispute.run(5.0, {0, 0}, 2.8);
  EXPECT_EQ(dispute.of.finding(), Finding::kWheelsWrong);
}

TEST(WheelDisputeTest, WheelsThatPulledTheFilterAlongHaveLedItAstrayByTheirShareOfItsWay) {
  Dispute dispute;
  dispute.run(5.2, {1.5, 1.5}, 3);
  const auto error = dispute.of.filter_error(10.0);
  EXPECT_NEAR(error.seconds, 5.2, 1e-9);
  EXPECT_NEAR(error.speed, 1.5, 1e-9) << "the difference with which it began";
  EXPECT_NEAR(error.position, 10.0 + 1.5 * 5.2, 1e-6) << "half as far as it believes: as far again";
}

TEST(WheelDisputeTest, WheelsThatWentWrongAtAStrokeHaveNotLedItAstray) {
  Dispute dispute({.wheels = 1.4, .imu = false});
  dispute.run(5.2, {1.5, 1.5}, 3);
  EXPECT_EQ(dispute.of.filter_error(10.0).speed, 0.0);
  EXPECT_EQ(dispute.of.filter_error(10.0).position, 0.0);
}

TEST(WheelDisputeTest, WheelsThatStandStillLeadItAstrayByNoMoreThanTwiceItsWay) {
  Dispute dispute;
  dispute.run(5.2, {0, 0}, 3);
  EXPECT_NEAR(dispute.of.filter_error(10.0).position, 20.0 + 3 * 5.2, 1e-6);
}

WheelObservation speeds(double wheels, double imu, std::int64_t end = 0) {
  WheelObservation observation;
  observation.end = end;
  observation.speed = {wheels, wheels};
  observation.inertial_speed = imu;
  return observation;
}

TEST(RecentSpeedsTest, TellWhoseSpeedHasLeapt) {
  RecentSpeeds recent;
  for (int i = 0; i < 5; ++i) recent.add(speeds(3, 17));
  EXPECT_FALSE(recent.leap().imu);
  recent.add(speeds(0, 17.1));
  EXPECT_FALSE(recent.leap().imu);
  EXPECT_NEAR(recent.leap().wheels, 2.9, 1e-9);
  for (int i = 0; i < 5; ++i) recent.add(speeds(3, 17));
  recent.add(speeds(3, 20));
  EXPECT_TRUE(recent.leap().imu);
}

TEST(RecentSpeedsTest, TellHowFarTheImuHasComeAwayFromTheWheels) {
  RecentSpeeds recent;
  std::int64_t now = 0;
  const auto after_a_second = [&](double wheels, double imu) {
    for (int i = 0; i < 20; ++i) recent.add(speeds(wheels, imu, now += kSampling));
  };
  after_a_second(0.7, 3);
  recent.add(speeds(0.72, 3.2, now += kSampling));
  EXPECT_NEAR(recent.leap().offset, -0.18, 1e-9);
  EXPECT_FALSE(recent.leap().imu);
  after_a_second(0.0, 3);
  recent.add(speeds(0.0, 3.09, now += kSampling));
  EXPECT_EQ(recent.leap().offset, 0.0) << "as it drives off, and the wheels do not turn";
  recent.add(speeds(0.7, 3.1, now += kSampling));
  EXPECT_EQ(recent.leap().offset, 0.0) << "the wheels' leap";
}

TEST(RecentSpeedsTest, AfterAnInterruptionNoImuHasLeapt) {
  RecentSpeeds recent;
  for (int i = 0; i < 5; ++i) recent.add(speeds(3, 17));
  recent.interrupt();
  recent.add(speeds(3, 30));
  EXPECT_FALSE(recent.leap().imu);
  recent.add(speeds(3, 30));
  recent.add(speeds(3, 31));
  EXPECT_TRUE(recent.leap().imu);
}

}  // namespace
}  // namespace curbstone::ekf::wheel_faults
