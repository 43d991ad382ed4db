// An axis of the gyro that is stuck at a small rate.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "drivers/imu/plausibility.hpp"
#include "tests/services/ekf/drawn_drives.hpp"
#include "tests/services/ekf/ground_error.hpp"
#include "tests/services/ekf/gyro_faults.hpp"
#include "tests/services/ekf/town_drive.hpp"

namespace curbstone::ekf::filter {
namespace {

struct StuckOutcome {
  double position = 0.0;  // m, largest error on the ground
  double sigmas = 0.0;    // largest, by the covariance, wherever it is more than 10 cm
  double square = 0.0;    // of the sigmas, on average; 2 is expected
  Counters counters;
};

StuckOutcome stuck_outcome(const Drive& drive) {
  Filter filter{base::EkfConfig()};
  std::vector<model::Estimate> out;
  for (std::size_t i = 0, w = 0; i < drive.imu.size() || w < drive.wheels.size();) {
    if (w == drive.wheels.size() || (i < drive.imu.size() && drive.imu[i].utime < drive.wheels[w].utime))
      filter.add(drive.imu[i++], out);
    else
      filter.add(drive.wheels[w++], out);
  }
  StuckOutcome outcome;
  if (out.empty()) return {INFINITY, INFINITY, INFINITY, filter.counters()};  // it never started
  const std::size_t start = drive.index_of(out.front().utime);
  int looks = 0;
  for (std::size_t i = 100; i + 20 < out.size(); i += 10, ++looks) {
    const GroundError error = ground_error(drive, start, out[i]);
    outcome.position = std::max(outcome.position, error.metres);
    if (error.metres > 0.1) outcome.sigmas = std::max(outcome.sigmas, error.sigmas);
    outcome.square += error.sigmas * error.sigmas;
  }
  outcome.square /= looks;
  outcome.counters = filter.counters();
  return outcome;
}

constexpr double kRest = 2.5;  // s, when it stands yet

struct StuckDrive {
  std::string name;
  Drive drive;
};

/// 80 s each.
std::vector<StuckDrive> stuck_drives(unsigned seed) {
  std::vector<StuckDrive> out;
  for (const double speed : {0.7, 3.0}) {
    TownDriveOptions o;
    o.seconds = 80;
    o.town = seed;
    o.seed = 5000 + seed;
    o.speed = speed;
    out.push_back({speed < 1 ? "town, 0.7 m/s" : "town, 3 m/s", simulate_town_drive(o, base::EkfConfig().vehicle)});
  }
  DriveOptions o;
  o.seconds = 80;
  o.seed = seed;
  o.stand_first = 4;
  o.gyro_bias << 0.004, -0.006, 0.003;
  o.accelerometer_bias << 0.03, -0.02, 0.04;
  o.gyro_noise = 1.3e-4;
  o.accelerometer_noise = 5e-3;
  o.wheel_scale << 0.004, 0.001, 0.01;
  out.push_back({"hills, 3 m/s", simulate_drive(o, base::EkfConfig().vehicle)});
  return out;
}

const char* gyro_axis(int axis) {
  static constexpr std::array kNames = {"x", "y", "z"};
  return kNames[static_cast<std::size_t>(axis)];
}

class StuckGyro : public ::testing::TestWithParam<int> {
 protected:
  /// `begins`: s, from when on it is stuck; of the middle of a bend by a drive.
  template <class Begins>
  static void expect_done_without(Begins begins) {
    const int axis = GetParam();
    for (const StuckDrive& good : stuck_drives(1)) {
      const StuckOutcome healthy = stuck_outcome(good.drive);
      std::printf("[ figure ] %s, healthy: %.2f m, mean square of the sigmas %.1f\n", good.name.c_str(),
                  healthy.position, healthy.square);
      EXPECT_EQ(healthy.counters.values().count(std::string("faults.gyro_") + gyro_axis(axis)), 0U);
      for (const double begin : begins(good.drive)) {
        for (const double rate : {0.0, 0.02, 0.09}) {
          StuckOutcome o = stuck_outcome(with_stuck_axis(good.drive, axis, rate, begin));
          std::printf("[ figure ] %s, %s stuck at %.2f rad/s from %.1f s on: %.2f m, %.1f sigma, mean square %.1f\n",
                      good.name.c_str(), gyro_axis(axis), rate, begin, o.position, o.sigmas, o.square);
          EXPECT_EQ(o.counters[std::string("faults.gyro_") + gyro_axis(axis)], 1);
          EXPECT_LT(o.position, healthy.position + (axis == 2 ? 0.1 * good.drive.distance : 1.0));
          EXPECT_LT(o.sigmas, 4.0);
          EXPECT_LT(o.square, healthy.square + 4.0);
        }
      }
    }
  }
};

/// Unnoticed it cost up to 136 m (z), 157 m (y) and 168 m (x), at up to 370 sigma. The wheels of a healthy vehicle may
/// differ by half a percent, and slip, and nothing else tells how it turns: z costs several percent of the way.
TEST_P(StuckGyro, IsDoneWithout) {
  expect_done_without([](const Drive& drive) { return std::array{kRest, middle_of_bend(drive, 15.0, 60.0)}; });
}

TEST_P(StuckGyro, IsDoneWithoutFromTheBeginningAndOnAStraight) {  // long
  expect_done_without([](const Drive&) { return std::array{0.0, 20.0}; });
}

/// The other axis of the two is the next one.
TEST_P(StuckGyro, OfTwoAxesThatGetStuckInOneMomentIsDoneWithout) {
  const int axis = GetParam(), other = (axis + 1) % 3;
  for (const StuckDrive& good : stuck_drives(1)) {
    const StuckOutcome healthy = stuck_outcome(good.drive);
    for (const double begin : {20.0, middle_of_bend(good.drive, 15.0, 60.0)}) {
      for (const double rate : {0.0, 0.02, 0.09}) {
        const Drive one = with_stuck_axis(good.drive, axis, rate, begin);
        StuckOutcome o = stuck_outcome(with_stuck_axis(one, other, -rate, begin));
        std::printf(
            "[ figure ] %s, %s and %s stuck at %.2f rad/s from %.1f s on: %.2f m, %.1f sigma, mean square %.1f\n",
            good.name.c_str(), gyro_axis(axis), gyro_axis(other), rate, begin, o.position, o.sigmas, o.square);
        EXPECT_EQ(o.counters[std::string("faults.gyro_") + gyro_axis(axis)], 1);
        EXPECT_EQ(o.counters[std::string("faults.gyro_") + gyro_axis(other)], 1);
        EXPECT_LT(o.position, healthy.position + (axis != 0 ? 0.12 * good.drive.distance : 2.0));
        EXPECT_LT(o.sigmas, 5.0);
      }
    }
  }
}

/// A gyro that shows nothing more, as after a reset of the device into another mode. The wheels tell how it turns.
TEST(StuckGyroWhole, ThatShowsZeroIsDoneWithout) {
  for (const StuckDrive& good : stuck_drives(1)) {
    const StuckOutcome healthy = stuck_outcome(good.drive);
    for (const double begin : {20.0, middle_of_bend(good.drive, 15.0, 60.0)}) {
      Drive drive = good.drive;
      for (int axis = 0; axis < 3; ++axis) drive = with_stuck_axis(drive, axis, 0.0, begin);
      StuckOutcome o = stuck_outcome(drive);
      std::printf("[ figure ] %s, all axes 0 from %.1f s on: %.2f m, %.1f sigma; healthy %.2f m\n", good.name.c_str(),
                  begin, o.position, o.sigmas, healthy.position);
      for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(o.counters[std::string("faults.gyro_") + gyro_axis(axis)], 1);
      EXPECT_LT(o.position, healthy.position + 0.12 * good.drive.distance);
      EXPECT_LT(o.sigmas, 5.0);
    }
  }
}

/// What a coarse gyro's driver makes of the drive: it withholds samples that cannot be, and names stuck axes.
Drive as_its_driver_says(Drive drive) {
  constexpr double kStep = 2000.0 / 32768 * std::numbers::pi / 180;  // rad/s, a WitMotion's
  imu::Plausibility judge;
  std::vector<base::ImuSample> published;
  for (base::ImuSample& sample : drive.imu) {
    for (double& rate : sample.angular_rate) rate = kStep * std::round(rate / kStep);
    const Eigen::Vector3d& a = sample.acceleration;
    const Eigen::Vector3d& w = sample.angular_rate;
    const auto verdict = judge.judge(sample.utime, {a.x(), a.y(), a.z()}, {w.x(), w.y(), w.z()});
    sample.stuck = judge.stuck_axes();
    const bool stuck = sample.stuck[0] || sample.stuck[1] || sample.stuck[2];
    const bool clips = w.cwiseAbs().maxCoeff() > 34.0;
    if (clips && !stuck) continue;  // its driver says so, and EkfNode refuses the sample
    if (verdict == imu::Plausibility::Verdict::kGood) published.push_back(sample);
  }
  drive.imu = std::move(published);
  return drive;
}

/// At a rate that no bias explains, of a gyro whose steps are too coarse for the filter's own watch. Its driver
/// withheld the whole IMU: the filter never started with an axis that was stuck from the beginning on, and lost 4 to 29
/// m in 60 s at 3 m/s where z got stuck at 0.5 rad/s on the way. Named only after 3 s it cost up to 190 m.
TEST_P(StuckGyro, OfACoarseGyroIsDoneWithoutAsItsDriverSays) {
  const int axis = GetParam();
  for (const StuckDrive& good : stuck_drives(3)) {
    const StuckOutcome healthy = stuck_outcome(as_its_driver_says(good.drive));
    for (const double begin : {0.0, 20.0}) {
      for (const double rate : {0.11, 0.5, 34.9}) {
        StuckOutcome o = stuck_outcome(as_its_driver_says(with_stuck_axis(good.drive, axis, rate, begin)));
        std::printf(
            "[ figure ] %s, %s stuck at %.2f rad/s from %.0f s on: %.2f m, %.1f sigma, mean square %.1f; healthy %.2f "
            "m\n",
            good.name.c_str(), gyro_axis(axis), rate, begin, o.position, o.sigmas, o.square, healthy.position);
        EXPECT_EQ(o.counters[std::string("faults.gyro_") + gyro_axis(axis)], 1);
        EXPECT_LT(o.position, healthy.position + (axis == 2 ? 0.1 * good.drive.distance : 1.0));
        EXPECT_LT(o.sigmas, 4.0);
      }
    }
  }
}

/// Its bias is not known any more then, until the vehicle stands.
TEST_P(StuckGyro, IsOwnedAgainWhenItLives) {
  const int axis = GetParam();
  for (const StuckDrive& good : stuck_drives(2)) {
    StuckOutcome o = stuck_outcome(with_stuck_axis(good.drive, axis, 0.05, 22.0, 27.0));
    std::printf("[ figure ] %s, %s stuck from 22 to 27 s: %.2f m, %.1f sigma, mean square %.1f\n", good.name.c_str(),
                gyro_axis(axis), o.position, o.sigmas, o.square);
    EXPECT_EQ(o.counters[std::string("faults.gyro_") + gyro_axis(axis)], 1);
    EXPECT_EQ(o.counters[std::string("trusted.gyro_") + gyro_axis(axis)], 1);
    EXPECT_LT(o.position, axis == 2 ? 3.0 : 2.0);
    EXPECT_LT(o.sigmas, 4.0);
  }
}
/// The successor of a filter that was killed meanwhile does not take the rate for a bias.
TEST_P(StuckGyro, LeavesABiasToWhoInherits) {
  const int axis = GetParam();
  const Drive drive =
      with_stuck_axis(simulate_drive({.seconds = 30.0, .stop_at = 1e9}, VehicleConfig()), axis, 0.02, 20.0);
  Filter filter{base::EkfConfig()};
  const auto out = run(filter, drive);
  ASSERT_TRUE(filter.axes().lost(axis));
  const model::Belief left = filter.axes().with_restored_biases(filter.belief());
  EXPECT_LT(left.mean.gyro_bias.norm(), 0.002);
  EXPECT_NEAR(std::sqrt(left.covariance(model::kGyroBias + axis, model::kGyroBias + axis)), 0.005, 1e-6);
  EXPECT_LT(out.back().gyro_bias.norm(), 0.002);
}
INSTANTIATE_TEST_SUITE_P(Axis, StuckGyro, ::testing::Values(0, 1, 2),
                         [](const auto& of) { return gyro_axis(of.param); });

}  // namespace
}  // namespace curbstone::ekf::filter
