// An IMU whose stamps a busy host made.
#include <gtest/gtest.h>

#include "services/ekf/inputs/stamp_smoother.hpp"
#include "tests/services/ekf/drawn_drives.hpp"
#include "tests/services/ekf/ground_error.hpp"
#include "tests/services/ekf/late_stamps.hpp"
#include "tests/services/ekf/town_drive.hpp"

namespace curbstone::ekf::filter {
namespace {

struct ImuStampOutcome {
  double position = 0.0;  // m, largest error on the ground
  double square = 0.0;    // of the sigmas by the covariance, on average; 2 is expected
};

ImuStampOutcome imu_stamp_outcome(const Drive& drive) {
  Filter filter{base::EkfConfig()};
  const auto out = run(filter, drive);
  const std::size_t start = drive.index_of(out.front().utime);
  ImuStampOutcome outcome;
  int looks = 0;
  for (std::size_t i = 100; i + 20 < out.size(); i += 50, ++looks) {
    const GroundError error = ground_error(drive, start, out[i]);
    outcome.position = std::max(outcome.position, error.metres);
    outcome.square += error.sigmas * error.sigmas;
  }
  outcome.square /= looks;
  return outcome;
}

class LateImuStamps : public ::testing::TestWithParam<int> {};

/// As they come, at 5 m/s and 100 Hz, stamps up to 20 ms late put the square from 1.5 to 3.1; up to 60 ms, to 21.
TEST_P(LateImuStamps, StraightenedCostNextToNothing) {
  for (const double speed : {0.7, 3.0, 5.0}) {
    TownDriveOptions options;
    options.seconds = 80.0;
    options.seed = 3000;
    options.speed = speed;
    options.imu_rate = GetParam();
    const Drive good = simulate_town_drive(options, base::EkfConfig().vehicle);
    const ImuStampOutcome undisturbed = imu_stamp_outcome(good);
    for (const double late : {0.005, 0.02, 0.06}) {
      Drive drive = good;
      make_late(drive.imu, late, 1);
      inputs::StampSmoother straightener;
      for (std::size_t i = 0; i < drive.imu.size(); ++i)
        drive.imu[i].utime = straightener.add(drive.imu[i].utime, static_cast<std::int32_t>(i));
      const ImuStampOutcome straightened = imu_stamp_outcome(drive);
      std::printf("[ figure ] %d Hz, %.1f m/s, up to %.0f ms late: %.2f m, mean square %.1f (undisturbed %.2f, %.1f)\n",
                  GetParam(), speed, 1e3 * late, straightened.position, straightened.square, undisturbed.position,
                  undisturbed.square);
      EXPECT_LT(straightened.position, undisturbed.position + (late > 0.02 ? 0.5 : 0.1)) << speed << ", " << late;
      EXPECT_LT(straightened.square, undisturbed.square + (late > 0.02 ? 2.0 : 0.3)) << speed << ", " << late;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Rate, LateImuStamps, ::testing::Values(100, 200));

}  // namespace
}  // namespace curbstone::ekf::filter
