// Wheels whose stamps a busy host made.
#include <gtest/gtest.h>

#include "tests/services/ekf/drawn_drives.hpp"
#include "tests/services/ekf/ground_error.hpp"
#include "tests/services/ekf/late_stamps.hpp"
#include "tests/services/ekf/town_drive.hpp"

namespace curbstone::ekf::filter {
namespace {

struct StampOutcome {
  double position = 0.0;  // m, largest error on the ground
  double sigmas = 0.0;    // by the covariance, at the end
  Counters counters;
};

StampOutcome outcome_of(const Drive& drive) {
  Filter filter{base::EkfConfig()};
  const auto out = run(filter, drive);
  const std::size_t start = drive.index_of(out.front().utime);
  StampOutcome outcome;
  for (const model::Estimate& e : out) {
    const GroundError error = ground_error(drive, start, e);
    outcome.position = std::max(outcome.position, error.metres);
    outcome.sigmas = error.sigmas;
  }
  outcome.counters = filter.counters();
  return outcome;
}

Drive drive_through_town(unsigned number, double speed) {
  TownDriveOptions options;
  options.seconds = 80.0;
  options.town = number;
  options.seed = 3000 + number;
  options.speed = speed;
  return simulate_town_drive(options, base::EkfConfig().vehicle);
}

class LateWheelStamps : public ::testing::TestWithParam<unsigned> {};

/// Believed, stamps up to 20 ms late cost 2 to 100 m at 10 to 50 sigma.
TEST_P(LateWheelStamps, CostLittleAndTheCovarianceCoversIt) {
  for (const double speed : {0.7, 3.0, 5.0}) {
    const Drive good = drive_through_town(GetParam(), speed);
    const StampOutcome undisturbed = outcome_of(good);
    for (const double late : {0.002, 0.005, 0.01, 0.02, 0.06}) {
      Drive drive = good;
      make_late(drive.wheels, late, GetParam());
      StampOutcome o = outcome_of(drive);
      std::printf("[ figure ] town %u, %.1f m/s, up to %.0f ms late: %.2f m (undisturbed %.2f), %.1f sigma\n",
                  GetParam(), speed, 1e3 * late, o.position, undisturbed.position, o.sigmas);
      EXPECT_LT(o.position, undisturbed.position + (late > 0.02 ? 1.5 : 0.5)) << late;
      EXPECT_LT(o.sigmas, 2.5) << late;
      EXPECT_EQ(o.counters["reset.doubt"], 0) << late;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Town, LateWheelStamps, ::testing::Values(1U, 2U));

}  // namespace
}  // namespace curbstone::ekf::filter
