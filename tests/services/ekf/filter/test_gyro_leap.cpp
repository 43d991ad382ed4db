// A gyro whose bias about the vertical leaps in mid-drive.
#include "services/ekf/detection/gyro_leap.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <numbers>

#include "tests/services/ekf/drawn_drives.hpp"
#include "tests/services/ekf/ground_error.hpp"
#include "tests/services/ekf/gyro_faults.hpp"
#include "tests/services/ekf/town_drive.hpp"
#include "tests/services/ekf/wheel_fault.hpp"

namespace curbstone::ekf::filter {
namespace {

constexpr double kDegreeASecond = std::numbers::pi / 180;

struct LeapOutcome {
  std::int64_t leaps = 0;
  double position = 0.0;  // m, largest error on the ground
  double square = 0.0;    // of the sigmas, on average; 2 is expected
};

LeapOutcome leap_outcome(const Drive& drive) {
  Filter filter{base::EkfConfig()};
  const std::vector<model::Estimate> out = run(filter, drive);
  LeapOutcome outcome{filter.counters()["gyro_leaps"]};
  if (out.empty() || drive.truth.empty()) return outcome;
  const std::size_t start = drive.index_of(out.front().utime);
  int looks = 0;
  for (std::size_t i = 100; i + 20 < out.size(); i += 10, ++looks) {
    const GroundError error = ground_error(drive, start, out[i]);
    outcome.position = std::max(outcome.position, error.metres);
    outcome.square += error.sigmas * error.sigmas;
  }
  outcome.square /= std::max(looks, 1);
  return outcome;
}

Drive round_a_block(unsigned number, double speed = 3.0) {
  return simulate_town_drive({.seconds = 80, .speed = speed, .seed = 7000 + number, .town = number}, VehicleConfig());
}

Drive with_leap(Drive drive, double at, double rate, double until = 1e9) {
  for (base::ImuSample& sample : drive.imu) {
    const double t = base::seconds_between(drive.imu.front().utime, sample.utime);
    if (t > at && t < until) sample.angular_rate.z() += rate;
  }
  return drive;
}

void expect_taken_out(std::initializer_list<unsigned> blocks) {
  for (const unsigned number : blocks) {
    const Drive drive = round_a_block(number);
    const LeapOutcome healthy = leap_outcome(drive);
    for (const double rate : {-2.0, 5.0, -20.0}) {
      for (const double at : {2.0, 10.0, middle_of_bend(drive, 20, 70)}) {
        const LeapOutcome leapt = leap_outcome(with_leap(drive, at, rate * kDegreeASecond));
        EXPECT_EQ(leapt.leaps, 1) << number << ' ' << rate << ' ' << at;
        EXPECT_LT(leapt.position, healthy.position + (std::abs(rate) > 10 ? 7 : 1))
            << number << ' ' << rate << ' ' << at;
        EXPECT_LT(leapt.square, 8) << number << ' ' << rate << ' ' << at;
      }
    }
  }
}

TEST(GyroLeap, IsTakenOutOfTheBiasAndTheHeading) {
  expect_taken_out({1});
}

TEST(GyroLeap, IsTakenOutOnOtherBlocks) {  // long
  expect_taken_out({2, 3});
}

TEST(GyroLeap, ThereAndBackAreTwo) {
  const Drive drive = round_a_block(1);
  const LeapOutcome leapt = leap_outcome(with_leap(drive, 10, 5 * kDegreeASecond, 25));
  EXPECT_EQ(leapt.leaps, 2);
  EXPECT_LT(leapt.position, leap_outcome(drive).position + 1);
}

void expect_no_leap(std::initializer_list<unsigned> blocks, std::initializer_list<double> onsets) {
  for (const unsigned number : blocks) {
    for (const double speed : {0.7, 3.0, 5.0})
      EXPECT_EQ(leap_outcome(round_a_block(number, speed)).leaps, 0) << number << ' ' << speed;
    const Drive block = round_a_block(number);
    for (const double scale : {0.5, 1.5, 2.0}) {
      Drive drive = block;
      for (base::ImuSample& sample : drive.imu) sample.angular_rate.z() *= scale;
      EXPECT_EQ(leap_outcome(drive).leaps, 0) << number << ' ' << scale;
    }
  }
  const Drive block = round_a_block(1);
  for (const WheelFault& fault : tried_wheel_faults()) {
    for (const double onset : onsets)
      EXPECT_EQ(leap_outcome(with_fault(block, fault, onset)).leaps, 0) << fault.name << ' ' << onset;
  }
}

TEST(GyroLeap, IsNoneWhereWheelsAreWrongOrAllIsWell) {
  expect_no_leap({1}, {20.0});
}

TEST(GyroLeap, IsNoneOnManyBlocksWheneverWheelsGoWrong) {  // long
  expect_no_leap({2, 3, 4, 5}, {1.0, 45.0});
}

/// About a level axis: the accelerometer tells.
TEST(TiltingGyro, ALeapAboutALevelAxisIsTakenOut) {
  for (const int axis : {0, 1}) {
    for (const double rate : {-2.0, 5.0}) {
      for (const double at : {10.0, 33.0}) {
        Drive drive = round_a_block(1);
        const LeapOutcome healthy = leap_outcome(drive);
        for (base::ImuSample& sample : drive.imu) {
          const double t = base::seconds_between(drive.imu.front().utime, sample.utime);
          if (t > at) sample.angular_rate[axis] += rate * kDegreeASecond;
        }
        const LeapOutcome leapt = leap_outcome(drive);
        EXPECT_EQ(leapt.leaps, 1) << axis << ' ' << rate << ' ' << at;
        EXPECT_LT(leapt.position, healthy.position + 4) << axis << ' ' << rate << ' ' << at;
        EXPECT_LT(leapt.square, 20) << axis << ' ' << rate << ' ' << at;
        Filter filter{base::EkfConfig()};
        const std::vector<model::Estimate> out = run(filter, drive);
        ASSERT_TRUE(filter.gyro_leapt());
        EXPECT_EQ(filter.gyro_leapt()->axis, axis);
        EXPECT_GT(filter.gyro_leapt()->rate * rate, 0.0);
        EXPECT_TRUE(out.back().level);
        EXPECT_NEAR(filter.belief().mean.gyro_bias[axis], rate * kDegreeASecond, 0.3 * kDegreeASecond);
      }
    }
  }
}

}  // namespace
}  // namespace curbstone::ekf::filter
