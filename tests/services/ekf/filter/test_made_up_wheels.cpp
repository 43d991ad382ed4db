// WHEELS that a gateway makes up: both go on at the speed of one moment while the vehicle brakes, stops and sets off.
#include <gtest/gtest.h>

#include "tests/services/ekf/drawn_drives.hpp"
#include "tests/services/ekf/ground_error.hpp"
#include "tests/services/ekf/town_drive.hpp"

namespace curbstone::ekf::filter {
namespace {

Drive town(unsigned number, double speed) {
  TownDriveOptions options;
  options.seconds = 70.0;
  options.town = options.seed = number;
  options.speed = speed;
  return simulate_town_drive(options, base::EkfConfig().vehicle);
}

/// From `onset` s to `end` both wheels go on as they turned then, counted in whole steps; then they count again.
Drive made_up(Drive drive, double onset, double end) {
  const auto at = static_cast<std::size_t>(onset * 100);
  const std::vector<base::WheelSample> true_wheels = drive.wheels;
  const base::WheelSample& from = true_wheels[at];
  const base::WheelSample& before = true_wheels[at - 20];
  std::array<double, 2> ahead = {};
  for (std::size_t i = at; i < drive.wheels.size(); ++i) {
    const double t = base::seconds_between(from.utime, drive.wheels[i].utime);
    for (std::size_t w = 0; w < 2; ++w) {
      const double rate = (from.angle[w] - before.angle[w]) / base::seconds_between(before.utime, from.utime);
      const double step = 2 * M_PI / 4096;
      if (onset + t < end) ahead[w] = step * std::floor((from.angle[w] + rate * t) / step) - true_wheels[i].angle[w];
      drive.wheels[i].angle[w] = true_wheels[i].angle[w] + ahead[w];
    }
  }
  return drive;
}

struct Outcome {
  double metres = 0.0;    // largest error on the ground
  double sigmas = 0.0;    // wherever it is more than 10 cm
  double withheld = 0.0;  // s, without wheels
  bool at_end = false;    // without wheels then
  Counters counters;
};

Outcome outcome(const Drive& drive) {
  Filter filter{base::EkfConfig()};
  const auto out = run(filter, drive);
  const std::size_t start = drive.index_of(out.front().utime);
  Outcome o;
  for (const model::Estimate& e : out) {
    const GroundError error = ground_error(drive, start, e);
    o.metres = std::max(o.metres, error.metres);
    if (error.metres > 0.1) o.sigmas = std::max(o.sigmas, error.sigmas);
    if (e.no_wheels) o.withheld += 0.01;
    o.at_end = e.no_wheels;
  }
  o.counters = filter.counters();
  return o;
}

TEST(MadeUpWheels, AreFoundAsTheVehicleBrakesAndNotBelieved) {
  for (const double speed : {1.0, 3.0, 5.0}) {
    for (const unsigned number : {1U, 2U, 3U}) {
      Outcome o = outcome(made_up(town(number, speed), 20, 1e9));
      std::printf("[ figure ] town %u, %.1f m/s, made up from 20 s on: at most %.2f m and %.1f sigma, %.1f s without\n",
                  number, speed, o.metres, o.sigmas, o.withheld);
      EXPECT_EQ(o.counters["faults.wheels_made_up"], 1);
      EXPECT_EQ(o.counters["faults.wheel_left"], 1);
      EXPECT_EQ(o.counters["faults.wheel_right"], 1);
      EXPECT_TRUE(o.at_end);
      // A vehicle that brakes for more than the patience has the filter doubt itself before they are found.
      EXPECT_LT(o.sigmas, speed < 5.0 ? 4.0 : 20.0);
    }
  }
}

TEST(MadeUpWheels, AreTrustedAgainOnceTheyCount) {
  Outcome o = outcome(made_up(town(1, 3.0), 20, 36));
  EXPECT_EQ(o.counters["faults.wheel_left"], 1);
  EXPECT_EQ(o.counters["trusted.wheel_left"], 1);
  EXPECT_FALSE(o.at_end);
}

TEST(MadeUpWheels, AreNoneOfAHealthyVehicleNorOfOneWhoseImuLeaps) {
  for (const double speed : {1.0, 3.0, 5.0}) {
    Drive drive = town(2, speed);
    EXPECT_EQ(outcome(drive).counters["faults.wheels_made_up"], 0);
    for (std::size_t i = 2000; i < 2004; ++i) drive.imu[i].acceleration.x() += 1.0 / 0.04;
    EXPECT_EQ(outcome(drive).counters["faults.wheels_made_up"], 0) << speed;
  }
}

}  // namespace
}  // namespace curbstone::ekf::filter
