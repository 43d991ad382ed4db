// Driving off from a standstill, the IMU alone knows the speed for some seconds: wheels that are wrong from the first
// metre on show then.
#include <gtest/gtest.h>

#include <initializer_list>

#include "tests/services/ekf/drawn_drives.hpp"
#include "tests/services/ekf/ground_error.hpp"
#include "tests/services/ekf/town_drive.hpp"
#include "tests/services/ekf/wheel_fault.hpp"

namespace curbstone::ekf::filter {
namespace {

struct LaunchOutcome {
  double position = 0.0;  // m, largest error on the ground
  double sigmas = 0.0;    // by the covariance, wherever it is more than 3 cm
  double found = 0.0;     // s, when both wheels are faulty; 0: never
  Counters counters;
};

LaunchOutcome launch_outcome(const Drive& drive) {
  Filter filter{base::EkfConfig()};
  const auto out = run(filter, drive);
  const std::size_t start = drive.index_of(out.front().utime);
  LaunchOutcome outcome;
  for (const model::Estimate& e : out) {
    const GroundError error = ground_error(drive, start, e);
    outcome.position = std::max(outcome.position, error.metres);
    if (error.metres > 0.03) outcome.sigmas = std::max(outcome.sigmas, error.sigmas);
    if (e.no_wheels && outcome.found == 0.0) outcome.found = base::seconds_between(drive.imu.front().utime, e.utime);
  }
  outcome.counters = filter.counters();
  return outcome;
}

/// It drives off at 4 s.
Drive launch_in_town(unsigned number, double speed) {
  TownDriveOptions options;
  options.seconds = 50.0;
  options.town = number;
  options.seed = 2000 + number;
  options.speed = speed;
  return simulate_town_drive(options, base::EkfConfig().vehicle);
}

/// Its wheels turn (1 + share) times as fast as its way from the start on, for `seconds`.
Drive spinning_at_launch(Drive drive, std::array<double, 2> share, double seconds) {
  const double radius = base::EkfConfig().vehicle.wheel_radius;
  std::array<double, 2> added{};
  for (std::size_t i = 1; i < drive.wheels.size(); ++i) {
    const double t = base::seconds_between(drive.wheels.front().utime, drive.wheels[i].utime);
    const double dt = base::seconds_between(drive.wheels[i - 1].utime, drive.wheels[i].utime);
    const double grip = std::clamp((4.0 + seconds - t) / 0.2, 0.0, 1.0);
    for (std::size_t wheel = 0; wheel < 2; ++wheel) {
      added[wheel] += grip * share[wheel] * drive.truth[std::min(i, drive.truth.size() - 1)].velocity.x() / radius * dt;
      drive.wheels[i].angle[wheel] += added[wheel];
    }
  }
  return drive;
}

class WheelLaunch : public ::testing::TestWithParam<unsigned> {};

/// Without it the wheels pull the filter along: 3 to 70 sigma, and both halved at 0.7 m/s are found after 39 s or
/// never.
TEST_P(WheelLaunch, BothWheelsThatAreWrongFromTheFirstMetreOnAreFoundAndCovered) {
  for (const double speed : {0.7, 3.0, 5.0}) {
    const Drive good = launch_in_town(GetParam(), speed);
    for (const double gain : {0.5, -1.0, 2.0}) {
      LaunchOutcome o = launch_outcome(with_fault(good, {"both", {gain, gain}}, 1.0));
      std::printf("[ figure ] town %u, %.1f m/s, both times %.1f: found at %.1f s, at most %.2f m and %.1f sigma\n",
                  GetParam(), speed, gain, o.found, o.position, o.sigmas);
      EXPECT_EQ(o.counters["faults.wheel_left"], 1) << gain;
      EXPECT_EQ(o.counters["faults.wheel_right"], 1) << gain;
      EXPECT_GT(o.found, 4.0) << gain;
      EXPECT_LT(o.found, 11.0) << gain;
      EXPECT_LT(o.sigmas, 4.0) << gain;
    }
  }
}

TEST_P(WheelLaunch, WheelsThatSpinOnIceAreForgivenAsSoonAsTheyHaveGrip) {
  for (const double speed : {0.7, 3.0, 5.0}) {
    const Drive good = launch_in_town(GetParam(), speed);
    const double undisturbed = launch_outcome(good).position;
    for (const std::array<double, 2> share : {std::array{0.5, 0.5}, {3.0, 3.0}, {0.4, 1.5}, {-0.5, -0.5}}) {
      for (const double seconds : {2.5, 4.5}) {
        LaunchOutcome o = launch_outcome(spinning_at_launch(good, share, seconds));
        EXPECT_EQ(o.counters["faults.wheel_left"] + o.counters["faults.wheel_right"], 0) << speed << ", " << share[0];
        EXPECT_LT(o.position, undisturbed + 0.5) << speed << ", " << share[0];
        EXPECT_LT(o.sigmas, 4.0) << speed << ", " << share[0];
      }
    }
  }
}

TEST_P(WheelLaunch, AGoodLaunchDisownsNoWheels) {
  for (const double speed : {0.7, 3.0, 5.0}) {
    LaunchOutcome o = launch_outcome(launch_in_town(GetParam(), speed));
    EXPECT_EQ(o.counters["launches.disowned"], 0) << speed;
  }
}

/// A vehicle that nods as it sets off turns its IMU, which the filter must not take for speed.
TEST_P(WheelLaunch, ASlowLaunchDisownsNoWheels) {
  for (const double speed : {0.1, 0.2, 0.3, 0.5}) {
    LaunchOutcome o = launch_outcome(launch_in_town(GetParam(), speed));
    std::printf("[ figure ] town %u, driving off at %.1f m/s: at most %.2f m and %.1f sigma\n", GetParam(), speed,
                o.position, o.sigmas);
    EXPECT_EQ(o.counters["launches.disowned"], 0) << speed;
    EXPECT_EQ(o.counters["faults.wheel_left"] + o.counters["faults.wheel_right"], 0) << speed;
    EXPECT_LT(o.position, 0.3) << speed;
    EXPECT_LT(o.sigmas, 3.0) << speed;
  }
}
INSTANTIATE_TEST_SUITE_P(Town, WheelLaunch, ::testing::Values(1U, 2U));

TEST(Launch, OnSteepWavesOfTheGroundItDisownsNoWheels) {
  for (const double hills : {0.1, 0.3}) {
    for (const double speed : {0.7, 3.0}) {
      DriveOptions options;
      options.hills = hills;
      options.speed = speed;
      options.stop_at = 20.0;
      options.seconds = 40.0;
      options.accelerometer_bias = {0.05, -0.03, 0.02};
      options.gyro_bias = {0.004, -0.003, 0.005};
      LaunchOutcome o = launch_outcome(simulate_drive(options, base::EkfConfig().vehicle));
      EXPECT_EQ(o.counters["launches.disowned"], 0) << hills << ", " << speed;
    }
  }
}

TEST(Launch, AJoltOfTheImuDisownsNoWheels) {
  for (const double jolt : {-1.0, -0.3, 0.3, 1.0}) {  // m/s within 50 ms
    for (const double speed : {0.7, 3.0}) {
      Drive drive = launch_in_town(1, speed);
      for (std::size_t i = 470; i < 475; ++i) drive.imu[i].acceleration.x() += jolt / 0.05;
      LaunchOutcome o = launch_outcome(drive);
      EXPECT_EQ(o.counters["launches.disowned"], 0) << jolt << ", " << speed;
    }
  }
}

/// A leap comes at once; wheels that are wrong are off by more and more as it speeds up. Taken for that, a leap cost up
/// to 13.7 m in 50 s.
void expect_no_wheels_disowned(std::initializer_list<double> leaps, std::initializer_list<unsigned> towns,
                               std::initializer_list<std::size_t> moments) {
  for (const double leap : leaps) {  // m/s within 50 ms
    LaunchOutcome worst;
    for (const unsigned town : towns) {
      const Drive good = launch_in_town(town, 0.7);
      for (const double sign : {-1.0, 1.0}) {
        for (const std::size_t at : moments) {
          Drive drive = good;
          for (std::size_t i = at; i < at + 5; ++i) drive.imu[i].acceleration.x() += sign * leap / 0.05;
          LaunchOutcome o = launch_outcome(drive);
          EXPECT_EQ(o.counters["launches.disowned"], 0) << town << ", " << sign * leap << " at " << at;
          worst.position = std::max(worst.position, o.position);
          worst.sigmas = std::max(worst.sigmas, o.sigmas);
        }
      }
    }
    std::printf("[ figure ] leaps of %.2f m/s as it drives off at 0.7 m/s: at most %.2f m and %.1f sigma\n", leap,
                worst.position, worst.sigmas);
    EXPECT_LT(worst.position, leap > 0.2 ? 2.0 : 1.6);
  }
}

TEST(Launch, ASmallLeapOfTheImuAtWalkingPaceDisownsNoWheels) {
  expect_no_wheels_disowned({0.25}, {1}, {400, 410, 420, 430, 440, 450, 470});
}

TEST(Launch, ASmallLeapOfTheImuInOtherTownsDisownsNoWheels) {  // long
  expect_no_wheels_disowned({0.25}, {2, 3}, {400, 410, 420, 430, 440, 450, 470});
}

TEST(Launch, StillSmallerLeapsOfTheImuDisownNoWheels) {  // long
  expect_no_wheels_disowned({0.1, 0.15, 0.2}, {1, 2, 3}, {400, 410, 420, 430, 440, 450, 470});
}

TEST(Launch, WithoutTheImuNothingIsDisowned) {
  Drive drive = launch_in_town(1, 3.0);
  const std::int64_t begin = drive.imu.front().utime;
  std::erase_if(drive.imu, [&](const base::ImuSample& sample) {
    const double t = base::seconds_between(begin, sample.utime);
    return t > 4.2 && t < 6.0;
  });
  LaunchOutcome o = launch_outcome(drive);
  EXPECT_EQ(o.counters["launches.disowned"], 0);
}

}  // namespace
}  // namespace curbstone::ekf::filter
