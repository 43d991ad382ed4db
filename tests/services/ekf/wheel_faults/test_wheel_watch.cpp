#include "services/ekf/wheel_faults/wheel_watch.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace curbstone::ekf::wheel_faults {
namespace {

using Finding = WheelWatch::Finding;

constexpr std::int64_t kWatchPeriod = 50'000;  // us
constexpr double kTrackWidth = 0.6;            // m

/// Wheels against a filter that believes to drive at `expected`.
struct Drive {
  WheelWatch watch{base::SlipConfig(), kTrackWidth};
  std::int64_t time = 0;
  double yaw_rate = 0;
  void step(std::array<double, 2> speed, double expected) {
    WheelObservation observation;
    observation.begin = time;
    observation.end = time += kWatchPeriod;
    observation.speed = speed;
    observation.expected = {expected - 0.5 * kTrackWidth * yaw_rate, expected + 0.5 * kTrackWidth * yaw_rate};
    observation.sigma = {0.03, 0.03};
    for (std::size_t i = 0; i < 2; ++i)
      observation.refused[i] = std::abs(speed[i] - observation.expected[i]) > 8 * 0.03;
    observation.yaw_rate = yaw_rate;
    observation.inertial_speed = expected;
    watch.add(observation);
  }
  void run(double seconds, std::array<double, 2> speed, double expected) {
    for (int i = 0; i < static_cast<int>(seconds * 20 + 0.5); ++i) step(speed, expected);
  }
};

TEST(WheelWatchTest, AWheelThatIsRefusedForThePatienceIsFaulty) {
  Drive drive;
  drive.run(10, {3, 3}, 3);
  drive.run(4.8, {0, 3}, 3);
  EXPECT_FALSE(drive.watch.faulty(0));
  drive.run(0.4, {0, 3}, 3);
  EXPECT_TRUE(drive.watch.faulty(0));
  EXPECT_FALSE(drive.watch.faulty(1));
  EXPECT_NEAR(drive.watch.ratio(0), 0, 1e-9);
  EXPECT_FALSE(drive.watch.standstill_unreliable());
}

TEST(WheelWatchTest, SlipThatEndsIsNoFault) {
  Drive drive;
  for (int i = 0; i < 100; ++i) {
    drive.run(0.7, {4, 3}, 3);
    drive.run(2.3, {3, 3}, 3);
  }
  EXPECT_FALSE(drive.watch.faulty(0));
}

TEST(WheelWatchTest, ItIsTrustedAgainAfterFiveSecondsOfAgreement) {
  Drive drive;
  drive.run(6, {6, 3}, 3);
  ASSERT_TRUE(drive.watch.faulty(0));
  drive.run(20, {0, 0}, 0);  // standing proves nothing
  drive.run(4.5, {3, 3}, 3);
  EXPECT_TRUE(drive.watch.faulty(0));
  drive.run(1, {3, 3}, 3);
  EXPECT_FALSE(drive.watch.faulty(0));
}

/// Its ratio to the truth comes and goes: it slips, or its stamps jitter.
TEST(WheelWatchTest, AWheelThatShowsNoConstantMultipleIsNotFaulty) {
  Drive drive;
  for (int i = 0; i < 600; ++i) drive.step({i % 2 == 0 ? 4.5 : 1.5, 3}, 3);
  for (int i = 0; i < 600; ++i) drive.step({3 + 2.0 * std::sin(0.1 * i), 3}, 3);
  EXPECT_FALSE(drive.watch.faulty(0) || drive.watch.faulty(1));
}

/// The track width is wrong, or it is a skid steer: what one wheel is off by goes with the turn.
TEST(WheelWatchTest, AWheelThatIsOffInTurnsOnlyIsNotFaulty) {
  for (const double skid : {0.5, 1.0, -0.4}) {
    Drive drive;
    for (int i = 0; i < 1200; ++i) {
      drive.yaw_rate = i % 300 < 200 ? 1.0 : -1.0;
      const double off = skid * kTrackWidth * drive.yaw_rate;
      drive.step({0.8 - 0.5 * kTrackWidth * drive.yaw_rate - off, 0.8 + 0.5 * kTrackWidth * drive.yaw_rate}, 0.8);
    }
    EXPECT_FALSE(drive.watch.faulty(0) || drive.watch.faulty(1)) << skid;
  }
}

TEST(WheelWatchTest, AWheelThatStandsStillInATurnIsFaultyOnceItGoesStraightOn) {
  Drive drive;
  drive.yaw_rate = 0.5;
  drive.run(20, {0, 3 + 0.5 * kTrackWidth * 0.5}, 3);
  drive.yaw_rate = 0.0;
  drive.run(5, {0, 3}, 3);
  EXPECT_TRUE(drive.watch.faulty(0));
  EXPECT_FALSE(drive.watch.faulty(1));
}

TEST(WheelWatchTest, BothThatShowAMultipleOfTheSpeedAreFaulty) {
  for (const double k : {0.0, -1.0, 0.5, 2.0}) {
    Drive drive;
    drive.run(10, {3, 3}, 3);
    drive.run(5.2, {3 * k, 3 * k}, 3);
    EXPECT_EQ(drive.watch.standstill_unreliable(), true);
    EXPECT_EQ(drive.watch.resolve_dispute(), Finding::kWheelsWrong) << k;
    EXPECT_TRUE(drive.watch.all_faulty());
    EXPECT_NEAR(drive.watch.ratio(1), k, 0.01);
    EXPECT_EQ(drive.watch.standstill_unreliable(), k == 0.0);
    EXPECT_EQ(drive.watch.filter_error().speed, 0.0) << "they went astray at a stroke";
  }
}

TEST(WheelWatchTest, BothThatShowWhatAWrongRadiusShowsAreNot) {
  for (const double k : {0.8, 0.9, 1.1, 1.2}) {
    Drive drive;
    drive.run(10, {3, 3}, 3);
    drive.run(5.2, {3 * k, 3 * k}, 3);
    EXPECT_EQ(drive.watch.resolve_dispute(), Finding::kFilterWrong) << k;
    EXPECT_FALSE(drive.watch.faulty(0) || drive.watch.faulty(1)) << k;
  }
}

/// Its tilt is wrong: the filter speeds up, the wheels go on as before.
TEST(WheelWatchTest, AFilterThatDriftsAwayEvenlyIsWrongItself) {
  for (const double drift : {-1.0, 0.7, 2.0}) {
    Drive drive;
    drive.run(10, {3, 3}, 3);
    for (int i = 0; i < 104; ++i) drive.step({3, 3}, 3 + drift * 0.05 * i);
    EXPECT_EQ(drive.watch.resolve_dispute(), Finding::kFilterWrong) << drift;
    EXPECT_FALSE(drive.watch.faulty(0) || drive.watch.faulty(1));
  }
}

/// As a small robot's did that shakes: away within seconds, and then it stays there.
TEST(WheelWatchTest, AFilterThatDriftsAwayAndStaysIsWrongItself) {
  for (const double far : {-3.0, 3.0}) {
    Drive drive;
    drive.run(10, {0.3, 0.3}, 0.3);
    for (int i = 0; i < 104; ++i) drive.step({0.33, 0.3}, 0.3 + far * std::tanh(0.025 * i));
    EXPECT_EQ(drive.watch.resolve_dispute(), Finding::kFilterWrong) << far;
  }
}

TEST(WheelWatchTest, AFilterWhoseImuWasHitIsWrongItself) {
  Drive drive;
  drive.run(10, {3, 3}, 3);
  drive.run(5.2, {3, 3}, 5);
  EXPECT_EQ(drive.watch.resolve_dispute(), Finding::kFilterWrong);
  EXPECT_FALSE(drive.watch.faulty(0) || drive.watch.faulty(1));
}

TEST(WheelWatchTest, StampsThatJitterAreNoFaultOfTheWheels) {
  Drive drive;
  drive.run(10, {3, 3}, 3);
  for (int i = 0; i < 104; ++i) drive.step(i % 2 == 0 ? std::array{4.2, 4.2} : std::array{1.8, 1.8}, 3);
  EXPECT_EQ(drive.watch.resolve_dispute(), Finding::kFilterWrong);
}

TEST(WheelWatchTest, WithoutEvidenceOfAllTheTimeNoWheelIsFaulty) {
  Drive drive;
  drive.run(10, {3, 3}, 3);
  drive.run(3, {0, 0}, 3);
  drive.watch.interrupt();  // samples were missing
  drive.run(2.2, {0, 0}, 3);
  EXPECT_EQ(drive.watch.resolve_dispute(), Finding::kFilterWrong);
  drive.watch.interrupt();
  EXPECT_EQ(drive.watch.resolve_dispute(), Finding::kFilterWrong);
}

TEST(WheelWatchTest, WheelsThatAreWrongEachInItsWayAreBothFaulty) {
  Drive drive;
  drive.run(10, {3, 3}, 3);
  drive.run(5.2, {0, 6}, 3);
  EXPECT_EQ(drive.watch.resolve_dispute(), Finding::kWheelsWrong);
  EXPECT_NEAR(drive.watch.ratio(0), 0, 0.01);
  EXPECT_NEAR(drive.watch.ratio(1), 2, 0.01);
}

}  // namespace
}  // namespace curbstone::ekf::wheel_faults
