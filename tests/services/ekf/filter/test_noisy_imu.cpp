// An IMU that is many times noisier than its file says, because the vehicle shakes or the unit is poor: the filter
// measures it, and neither wheels nor standing are taken for what they are not.
#include <gtest/gtest.h>

#include "tests/services/ekf/drawn_drives.hpp"
#include "tests/services/ekf/ground_error.hpp"
#include "tests/services/ekf/town_drive.hpp"

namespace curbstone::ekf::filter {
namespace {

struct NoisyOutcome {
  double position = 0.0;  // m, largest error on the ground
  double sigmas = 0.0;    // by the covariance, wherever it is more than 3 cm
  bool no_wheels = false;
  Counters counters;
};

NoisyOutcome noisy_outcome(TownDriveOptions options) {
  options.seconds = 60.0;
  options.seed = 3000 + options.town;
  const Drive drive = simulate_town_drive(options, base::EkfConfig().vehicle);
  Filter filter{base::EkfConfig()};
  const auto out = run(filter, drive);
  const std::size_t start = drive.index_of(out.front().utime);
  NoisyOutcome outcome;
  for (const model::Estimate& e : out) {
    const GroundError error = ground_error(drive, start, e);
    outcome.position = std::max(outcome.position, error.metres);
    if (error.metres > 0.03) outcome.sigmas = std::max(outcome.sigmas, error.sigmas);
    outcome.no_wheels |= e.no_wheels;
  }
  outcome.counters = filter.counters();
  std::printf("[ figure ] town %u, %.1f m/s, gyro %.4f rad/s, vibration %.2f m/s^2: at most %.2f m, %.1f sigma\n",
              options.town, options.speed, options.gyro_noise, options.vibration, outcome.position, outcome.sigmas);
  return outcome;
}

class NoisyImu : public ::testing::TestWithParam<unsigned> {};

TEST_P(NoisyImu, OfAVehicleThatShakesDisownsNoWheels) {
  for (const double speed : {1.0, 3.0, 6.0}) {
    for (const double vibration : {0.5, 1.0, 3.0}) {
      NoisyOutcome o = noisy_outcome({.speed = speed, .town = GetParam(), .vibration = vibration});
      EXPECT_FALSE(o.no_wheels);
      EXPECT_EQ(o.counters["faults.wheel_left"] + o.counters["faults.wheel_right"], 0);
      EXPECT_EQ(o.counters["launches.disowned"], 0);
      EXPECT_EQ(o.counters["starts.standing"], 1);
      EXPECT_LT(o.position, 3.0);
      EXPECT_LT(o.sigmas, 4.0);
    }
  }
}

TEST_P(NoisyImu, OfAPoorGyroStandsStillAndTurnsByTheWheelsToo) {
  for (const double speed : {1.0, 3.0, 6.0}) {
    NoisyOutcome o = noisy_outcome({.speed = speed, .town = GetParam(), .gyro_noise = 0.02});
    EXPECT_FALSE(o.no_wheels);
    EXPECT_EQ(o.counters["starts.standing"], 1);
    EXPECT_GE(o.counters["standstills"], 1);
    EXPECT_LT(o.position, 2.0);
    EXPECT_LT(o.sigmas, 4.0);
  }
}

INSTANTIATE_TEST_SUITE_P(Town, NoisyImu, ::testing::Values(1U, 3U));

}  // namespace
}  // namespace curbstone::ekf::filter
