#include "services/ekf/inputs/wheel_odometer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace curbstone::ekf::inputs {
namespace {

using Step = WheelOdometer::Step;

constexpr double kWheelRadius = 0.1;  // m
constexpr double kMaxGap = 0.2;       // s
constexpr std::int64_t kFirst = 1'000'000;
constexpr std::int64_t kSamplePeriod = 12'000;  // us between samples

class WheelOdometerTest : public ::testing::Test {
 protected:
  /// Both wheels' angles at a time of an even drive.
  static base::WheelSample rolling(std::int64_t since_start, double left, double right) {
    const double t = base::seconds_between(0, since_start);
    return {kFirst + since_start, {3.0 + left / kWheelRadius * t, -7.0 + right / kWheelRadius * t}};
  }
  base::WheelsConfig config_;  // an interval is 0.05 s
  WheelOdometer odometer_{config_, kWheelRadius, kMaxGap};
};

TEST_F(WheelOdometerTest, AnIntervalIsCompleteOnceItIsAsLongAsConfigured) {
  std::vector<Step> steps;
  for (int i = 0; i <= 10; ++i) steps.push_back(odometer_.add(rolling(i * kSamplePeriod, 1, 1)));
  const std::vector<Step> expected = {Step::kFirst, Step::kOpen,     Step::kOpen,    Step::kOpen,
                                      Step::kOpen,  Step::kInterval, Step::kOpen,    Step::kOpen,
                                      Step::kOpen,  Step::kOpen,     Step::kInterval};
  EXPECT_EQ(steps, expected);
}

TEST_F(WheelOdometerTest, AFirstSampleThatIsOffTheBeatIsLeftOut) {
  for (const double periods : {-0.8, -0.4, 1.0, 2.0}) {
    odometer_.reset();
    base::WheelSample first = rolling(0, 3, 3);
    for (double& angle : first.angle) angle -= periods * 3 / kWheelRadius * 1e-6 * kSamplePeriod;
    EXPECT_EQ(odometer_.add(first), Step::kFirst);
    int i = 1;
    while (odometer_.add(rolling(i * kSamplePeriod, 3, 3)) != Step::kInterval) ++i;
    EXPECT_EQ(odometer_.interval().begin, kFirst + kSamplePeriod) << periods;
    EXPECT_NEAR(odometer_.interval().mean_speed(), 3, 1e-9) << periods;
  }
}

TEST_F(WheelOdometerTest, AFirstSampleFromWhichTheWheelsSpeedUpIsNot) {
  const auto at = [](double t) { return base::WheelSample{kFirst + std::llround(t * 1e6), {50 * t * t, 50 * t * t}}; };
  double t = 0;
  while (odometer_.add(at(t)) != Step::kInterval) t += 0.012;  // 10 m/s^2
  EXPECT_EQ(odometer_.interval().begin, kFirst);
}

TEST_F(WheelOdometerTest, AnEvenDriveHasTheSpeedOfItsRims) {
  for (int i = 0; i <= 5; ++i) (void)odometer_.add(rolling(i * kSamplePeriod, 1.5, -0.5));
  const WheelInterval& interval = odometer_.interval();
  EXPECT_EQ(interval.begin, kFirst);
  EXPECT_EQ(interval.end, kFirst + 5 * kSamplePeriod);
  EXPECT_NEAR(interval.speed[0], 1.5, 1e-9);
  EXPECT_NEAR(interval.speed[1], -0.5, 1e-9);
  EXPECT_NEAR(interval.mean_speed(), 0.5, 1e-9);
  ASSERT_TRUE(odometer_.newest());
  EXPECT_EQ(odometer_.newest()->begin, kFirst + 4 * kSamplePeriod);
  EXPECT_NEAR(odometer_.newest()->speed[0], 1.5, 1e-9);
}

TEST_F(WheelOdometerTest, IntervalsTouchSoThatTheirSumIsTheTravelHoweverUnevenlyItIsSampled) {
  std::mt19937 random(1);
  std::int64_t utime = kFirst, end = kFirst;
  double angle = 0, travel = 0;
  int intervals = 0;
  for (int i = 0; i < 5000; ++i) {
    const auto step = odometer_.add({utime, {angle, angle}});
    if (step == Step::kInterval) {
      EXPECT_EQ(odometer_.interval().begin, end);
      end = odometer_.interval().end;
      travel += odometer_.interval().speed[0] * odometer_.interval().duration();
      EXPECT_NEAR(travel, kWheelRadius * angle, 1e-9);
      ++intervals;
    }
    utime += 2'000 + static_cast<std::int64_t>(random() % 30'000);
    angle += 1e-3 * static_cast<double>(random() % 100);
  }
  EXPECT_GT(intervals, 200);
}

TEST_F(WheelOdometerTest, AfterAGapAnIntervalBeginsAnew) {
  for (int i = 0; i < 3; ++i) (void)odometer_.add(rolling(i * kSamplePeriod, 1, 1));
  const std::int64_t after = 2 * kSamplePeriod + 200'001;
  EXPECT_EQ(odometer_.add(rolling(after, 1, 1)), Step::kGap);
  EXPECT_FALSE(odometer_.newest());
  for (int i = 1; i < 5; ++i) EXPECT_EQ(odometer_.add(rolling(after + i * kSamplePeriod, 1, 1)), Step::kOpen);
  EXPECT_EQ(odometer_.add(rolling(after + 5 * kSamplePeriod, 1, 1)), Step::kInterval);
  EXPECT_EQ(odometer_.interval().begin, kFirst + after);
}

TEST_F(WheelOdometerTest, AStampThatDoesNotGrowIsAGapToo) {
  (void)odometer_.add(rolling(kSamplePeriod, 1, 1));
  EXPECT_EQ(odometer_.add(rolling(kSamplePeriod, 1, 1)), Step::kGap);
  EXPECT_EQ(odometer_.add(rolling(0, 1, 1)), Step::kGap);
  EXPECT_EQ(odometer_.add(rolling(kSamplePeriod, 1, 1)), Step::kOpen);
}

TEST_F(WheelOdometerTest, ACounterThatRestartsIsNonsenseOnceAndIsFollowedFromThere) {
  for (const std::size_t wheel : {0U, 1U}) {
    odometer_.reset();
    for (int i = 0; i < 3; ++i) (void)odometer_.add(rolling(i * kSamplePeriod, 1, 1));
    base::WheelSample sample = rolling(3 * kSamplePeriod, 1, 1);
    sample.angle[wheel] = 1000;
    EXPECT_EQ(odometer_.add(sample), Step::kNonsense);
    EXPECT_FALSE(odometer_.newest());
    sample.utime += kSamplePeriod;
    sample.angle[wheel] += 1;
    EXPECT_EQ(odometer_.add(sample), Step::kOpen);
    EXPECT_NEAR(odometer_.newest()->speed[wheel], kWheelRadius * 1 / 0.012, 1e-9);
  }
}

TEST_F(WheelOdometerTest, AnAngleThatIsNoNumberIsNonsense) {
  (void)odometer_.add(rolling(0, 1, 1));
  EXPECT_EQ(odometer_.add({kFirst + kSamplePeriod, {std::nan(""), 0}}), Step::kNonsense);
}

TEST_F(WheelOdometerTest, ALateStampBeforeItDoesNotMakeAFastWheelNonsense) {
  // 35 m/s of at most 40, and the stamp of the first sample 9 of 12 ms late: that looks like 140 m/s.
  base::WheelSample late = rolling(0, 35, 35);
  late.utime += 9'000;
  (void)odometer_.add(late);
  EXPECT_EQ(odometer_.add(rolling(kSamplePeriod, 35, 35)), Step::kOpen);
}

/// The standard deviation of the speed that an odometer measures of an even drive, from what disturbs it.
double measured_sigma(const base::WheelsConfig& config, double speed) {
  std::mt19937 random(1);
  std::normal_distribution<double> unit;
  constexpr int kTries = 4000;
  double sum = 0, squares = 0;
  for (int i = 0; i < kTries; ++i) {
    WheelOdometer odometer(config, kWheelRadius, kMaxGap);
    for (const std::int64_t t : {std::int64_t{0}, std::int64_t{60'000}}) {
      const double angle = speed / kWheelRadius * 1e-6 * static_cast<double>(t) + config.angle_noise * unit(random);
      const std::int64_t stamp = kFirst + t + std::llround(1e6 * config.stamp_noise * unit(random));
      (void)odometer.add({stamp, {angle, angle}});
    }
    sum += odometer.interval().speed[0];
    squares += std::pow(odometer.interval().speed[0], 2);
  }
  return std::sqrt(squares / kTries - std::pow(sum / kTries, 2));
}

TEST_F(WheelOdometerTest, SigmaIsThatOfSpeedsMeasuredWithNoisyStampsAndAngles) {
  config_.speed_noise = config_.slip_noise = 0;
  const WheelInterval fast{0, 60'000, {5.0, 5.0}}, slow{0, 60'000, {0.5, 0.5}};
  config_.angle_noise = 0;
  EXPECT_NEAR(measured_sigma(config_, 5.0) / wheel_sigma(config_, fast, kWheelRadius, 0), 1.0, 0.05);
  config_.angle_noise = 2e-3;
  EXPECT_NEAR(measured_sigma(config_, 0.5) / wheel_sigma(config_, slow, kWheelRadius, 0), 1.0, 0.05);
}

/// A speed is wrong by as much as the duration is.
TEST_F(WheelOdometerTest, WhereStampsJitterIntervalsAreLongerAndTheirSigmaSaysByHowMuchTheyAreOff) {
  std::mt19937 random(1);
  std::normal_distribution<double> jitter(0.0, 3'000.0);  // us
  int intervals = 0;
  double squares = 0.0;
  double shortest = INFINITY;
  for (int i = 0; i < 6000; ++i) {
    const std::int64_t utime = kFirst + 20'000 * i;
    const double angle = 5.0 / kWheelRadius * 1e-6 * static_cast<double>(utime);
    const auto step = odometer_.add({utime + std::llround(jitter(random)), {angle, angle}});
    if (step != Step::kInterval || i < 100) continue;
    const WheelInterval& interval = odometer_.interval();
    ++intervals;
    squares += std::pow((interval.speed[0] - 5.0) / wheel_sigma(config_, interval, kWheelRadius, 0), 2);
    shortest = std::min(shortest, interval.duration());
  }
  EXPECT_GT(shortest, 0.08);
  EXPECT_GT(intervals, 700);
  EXPECT_NEAR(std::sqrt(squares / intervals), 1.0, 0.15);
}

TEST_F(WheelOdometerTest, SigmaOfAWheelOnItsOwnGrowsWithItsSlipOnly) {
  config_.angle_noise = config_.stamp_noise = 0;
  const WheelInterval turning{0, 50'000, {0.0, -2.0}};
  EXPECT_DOUBLE_EQ(wheel_sigma(config_, turning, kWheelRadius, 0), config_.speed_noise);
  EXPECT_DOUBLE_EQ(wheel_sigma(config_, turning, kWheelRadius, 1),
                   std::hypot(config_.speed_noise, 2 * config_.slip_noise));
}

}  // namespace
}  // namespace curbstone::ekf::inputs
