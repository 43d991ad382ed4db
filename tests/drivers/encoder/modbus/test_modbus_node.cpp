#include "drivers/encoder/modbus_node.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "tests/drivers/recorder.hpp"
#include "tests/stamps.hpp"

namespace curbstone::encoder {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using test::kStart;
constexpr std::int64_t kPeriod = 20'000;

class ModbusNodeTest : public ::testing::Test {
 protected:
  /// Both wheels at `speed` rad/s forward, for `samples` polls.
  void run(int samples, double speed = 10) {
    for (int i = 0; i < samples; ++i) {
      now_ += kPeriod;
      angle_ += speed * 1e-6 * kPeriod;
      const auto counts = static_cast<std::int64_t>(angle_ * 4096 / (2 * M_PI));
      reading_.utime = now_;
      reading_.time = now_ - set_by_ - kBoot;
      reading_.round_trip = 4'000;
      reading_.counts = {wrap(first_ + counts + leap_), wrap(first_ - counts)};
      if (!stale_) reading_.state_time = reading_.faults_time = reading_.time;
      node_.on_reading(now_ + 2'000, reading_);
      node_.tick(now_ + 2'000);
    }
  }
  static std::int32_t wrap(std::int64_t counts) {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(counts));
  }

  test::Recorder<wheels_t> recorder_{"WHEELS"};
  ModbusNode node_{EncoderConfig{}, recorder_.bus()};
  modbus::Reading reading_{.state = {true, false, false}};
  static constexpr std::int64_t kBoot = kStart - 1'000'000;  // the steady clock counts from then
  std::int64_t now_ = kStart;
  std::int64_t set_by_ = 0;  // us, the host's clock so far
  std::int64_t first_ = 0;
  std::int64_t leap_ = 0;  // counts, of the left wheel
  double angle_ = 0;
  bool stale_ = false;
};

TEST_F(ModbusNodeTest, BothWheelsGoForwardAndTheStampIsTheReadings) {
  run(100);
  ASSERT_EQ(recorder_.messages().size(), 99u) << "all but the first, which has no speed";
  const wheels_t& last = recorder_.messages().back();
  EXPECT_EQ(last.utime, now_);
  EXPECT_TRUE(last.enabled);
  for (int side = 0; side < 2; ++side) {
    EXPECT_NEAR(last.speed[side], 10, 0.1);
    EXPECT_NEAR(last.angle[side], 99 * 0.2, 0.01);
  }
  EXPECT_THAT(node_.report().faults, IsEmpty());
}

TEST_F(ModbusNodeTest, CountsAreUnwrappedAcrossInt32) {
  first_ = INT32_MAX - 500;
  run(100);
  EXPECT_NEAR(recorder_.messages().back().angle[0], 19.8, 0.01);
  EXPECT_NEAR(recorder_.messages().back().angle[1], 19.8, 0.01);
  EXPECT_EQ(node_.report().counters["refused.jump"], 0);
}

TEST_F(ModbusNodeTest, AfterASilenceTheCountsBeginAnewAndNoSpeedIsMadeUp) {
  run(50);
  const wheels_t before = recorder_.messages().back();
  now_ += 3'000'000;
  first_ = -wrap(static_cast<std::int64_t>(angle_ * 4096 / (2 * M_PI)));  // it lost power: it counts from 0
  run(50);
  EXPECT_EQ(node_.report().counters["counts_restarted"], 1);
  const wheels_t& first = recorder_.messages()[49];
  EXPECT_NEAR(first.speed[0], 10, 0.2);
  EXPECT_NEAR(first.angle[0] - before.angle[0], 0.2, 0.01);
}

TEST_F(ModbusNodeTest, OneReadingThatCannotBeIsRefused) {
  run(20);
  const double angle = recorder_.messages().back().angle[0];
  now_ += kPeriod;
  reading_.utime = now_;
  reading_.time += kPeriod;
  angle_ += 10e-6 * kPeriod;
  reading_.counts[0] += 1 << 24;
  node_.on_reading(now_, reading_);
  run(1);
  EXPECT_EQ(node_.report().counters["refused.jump"], 1);
  EXPECT_NEAR(recorder_.messages().back().angle[0] - angle, 0.4, 0.01);
}

TEST_F(ModbusNodeTest, OneReadingThatLeapsIsRefusedThoughAWheelCanTurnThatFar) {
  run(20);
  const double angle = recorder_.messages().back().angle[0];
  for (const int leap : {64, -256, 1024}) {
    leap_ = leap;
    run(1);
    leap_ = 0;
    run(5);
  }
  EXPECT_EQ(node_.report().counters["refused.outlier"], 3);
  EXPECT_EQ(recorder_.messages().size(), 34U);
  EXPECT_NEAR(recorder_.messages().back().angle[0] - angle, 18 * 0.2, 0.01);
}

TEST_F(ModbusNodeTest, AGatewayThatRenewsItsCountsMoreRarelyThanItIsAskedMakesNoWrongSpeed) {
  run(2);
  for (int i = 0; i < 100; ++i) {
    run(1);
    for (int old = 0; old < 4; ++old) {
      reading_.utime = now_ += kPeriod;
      reading_.time += kPeriod;
      angle_ += 10e-6 * kPeriod;
      node_.on_reading(now_, reading_);
      node_.tick(now_);
    }
  }
  for (const wheels_t& message : recorder_.messages()) EXPECT_NEAR(message.speed[0], 10, 0.1);
  EXPECT_NEAR(recorder_.messages().back().angle[0], 10e-6 * kPeriod * 497, 0.01);
  EXPECT_EQ(node_.report().counters["refused.old_counts"], 400);
  EXPECT_THAT(node_.report().faults, Contains(HasSubstr("refused.old_counts")));
}

TEST_F(ModbusNodeTest, FaultsOfTheDriveAreReportedByWheelAndByName) {
  reading_.faults = {0, 0x0404};
  reading_.state = {false, true, true};
  run(10);
  EXPECT_THAT(node_.report().faults, Contains("drive, right wheel: over-current, motor temperature"));
  EXPECT_THAT(node_.report().faults, Contains("drive: alarm"));
  EXPECT_THAT(node_.report().faults, Contains("drive: emergency stop"));
  EXPECT_FALSE(recorder_.messages().back().enabled);
  EXPECT_EQ(recorder_.messages().back().faults[1], 0x0404);
}

TEST_F(ModbusNodeTest, FaultsAndStatusThatAreNotKnownAreAFault) {
  stale_ = true;
  run(200);
  EXPECT_THAT(node_.report().faults, Contains(HasSubstr("the drive's faults are not known for 4 s")));
  EXPECT_THAT(node_.report().faults, Contains(HasSubstr("the drive's status is not known for 4 s")));
  EXPECT_FALSE(recorder_.messages().back().enabled);
}

TEST_F(ModbusNodeTest, WhatWasReadLongAgoIsNoFaultOfNow) {
  reading_.faults = {0, 0x0404};
  reading_.state = {false, true, true};
  run(10);
  stale_ = true;
  run(200);
  EXPECT_THAT(node_.report().faults, ::testing::Not(Contains(HasSubstr("alarm"))));
  EXPECT_THAT(node_.report().faults, ::testing::Not(Contains(HasSubstr("over-current"))));
  EXPECT_THAT(node_.report().faults, Contains(HasSubstr("the drive's status is not known for 4 s")));
}

TEST_F(ModbusNodeTest, ADriveWhoseStatusIsOldIsNotCalledEnabled) {
  run(10);
  EXPECT_TRUE(recorder_.messages().back().enabled);
  stale_ = true;
  run(200);
  EXPECT_FALSE(recorder_.messages().back().enabled);
}

TEST_F(ModbusNodeTest, TheUncertaintyOfTheStampsIsReported) {
  run(100);
  EXPECT_EQ(node_.report().counters["modbus.round_trip_us"], 4'000);
  EXPECT_EQ(node_.report().counters["stamp.uncertainty_us"], 2'000);
}

TEST_F(ModbusNodeTest, EncoderLinesThatDoNotFitAreReported) {
  reading_.encoder_lines = 4096;
  run(2);
  EXPECT_THAT(node_.report().faults, Contains(HasSubstr("16384 counts a revolution, not 4096")));
}

/// A gateway that answers from its memory while the vehicle drives.
TEST_F(ModbusNodeTest, OldRegistersThatTellOfASpeedAreWithheldAndReported) {
  reading_.speeds = {955, -955};  // 0.1 rpm
  run(100);
  const double angle = recorder_.messages().back().angle[0];
  run(60, 0);
  const std::size_t before = recorder_.messages().size();
  const std::int64_t withheld = node_.report().counters["withheld.stuck"];
  EXPECT_NEAR(static_cast<double>(withheld), 10, 2);  // after a second
  run(500, 0);
  EXPECT_EQ(recorder_.messages().size(), before);
  EXPECT_EQ(recorder_.messages().back().angle[0], angle);
  EXPECT_EQ(node_.report().counters["withheld.stuck"], withheld + 500);
  EXPECT_THAT(node_.report().faults, Contains(HasSubstr("the count of the left wheel stands still")));
  run(100);
  EXPECT_THAT(node_.report().faults, IsEmpty());
}

TEST_F(ModbusNodeTest, AVehicleThatStandsIsNotStuck) {
  reading_.speeds = {10, -15};  // noise
  run(1000, 0);
  EXPECT_EQ(recorder_.messages().size(), 999u);
  EXPECT_THAT(node_.report().faults, IsEmpty());
}

TEST_F(ModbusNodeTest, ASilentDriveIsAFault) {
  run(10);
  node_.tick(now_ + 5'000'000);
  EXPECT_THAT(node_.report().faults, Contains("no positions from the drive for 5 s"));
}

TEST_F(ModbusNodeTest, ReadingsOfEveryValueAreSurvived) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 20'000; ++i) {
    reading_.utime = random() % 10 == 0 ? static_cast<std::int64_t>(random() >> 2) : now_ + i * kPeriod;
    reading_.time = random() % 10 == 0 ? static_cast<std::int64_t>(random() >> 2) : 1 + i * kPeriod;
    reading_.round_trip = static_cast<std::int64_t>(random() % 60'000);
    reading_.counts = {static_cast<std::int32_t>(random()), static_cast<std::int32_t>(random())};
    reading_.faults = {static_cast<std::uint16_t>(random()), static_cast<std::uint16_t>(random())};
    node_.on_reading(now_ + i * kPeriod, reading_);
  }
  for (const wheels_t& message : recorder_.messages()) {
    ASSERT_TRUE(std::isfinite(message.speed[0]));
    ASSERT_LE(std::abs(message.speed[0]), 61);
  }
}

/// The host's clock is set while the wheels turn.
class ModbusNodeOnASetClock : public ModbusNodeTest, public ::testing::WithParamInterface<double> {};

TEST_P(ModbusNodeOnASetClock, SpeedsAndAnglesGoOnAndTheStampsFollow) {
  run(100);
  const std::int64_t by = std::llround(GetParam() * 1e6);
  now_ += by;
  set_by_ += by;
  node_.clock_was_set(by);
  node_.tick(now_);
  EXPECT_THAT(node_.report().faults, IsEmpty());
  run(20);
  NodeReport report = node_.report();
  EXPECT_EQ(report.counters["counts_restarted"], 0);
  EXPECT_THAT(report.faults, IsEmpty()) << "no age is taken from two clocks";
  run(100);
  for (const wheels_t& message : recorder_.messages()) EXPECT_NEAR(message.speed[0], 10, 0.1);
  const wheels_t& last = recorder_.messages().back();
  EXPECT_EQ(last.utime, now_);
  EXPECT_NEAR(last.angle[0], 219 * 0.2, 0.01) << "no way is lost";
  // After a step back by less than 0.1 s messages wait until the clock has passed the last stamp.
  EXPECT_GE(recorder_.messages().size(), 219U - 6U);
}
INSTANTIATE_TEST_SUITE_P(By, ModbusNodeOnASetClock,
                         ::testing::Values(-3600, -1, -0.5, -0.05, -0.005, 0.005, 0.06, 0.5, 3600));

}  // namespace
}  // namespace curbstone::encoder
