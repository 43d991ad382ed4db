#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "tests/services/ekf/drawn_drives.hpp"
#include "tests/services/ekf/town_drive.hpp"

namespace curbstone::ekf::filter {
namespace {

// Services that start while the vehicle drives know nothing of the gyro's bias until it stands for the first time.

/// What is left of a drive after so many seconds.
Drive without_beginning(Drive drive, double seconds) {
  const auto cut = [&](auto& samples) {
    const std::int64_t begin = drive.truth.front().utime + static_cast<std::int64_t>(1e6 * seconds);
    std::erase_if(samples, [&](const auto& s) { return s.utime < begin; });
  };
  cut(drive.imu);
  cut(drive.wheels);
  cut(drive.truth);
  drive.distance = 0.0;
  for (std::size_t i = 1; i < drive.truth.size(); ++i)
    drive.distance +=
        (drive.truth[i].T_world_base.translation() - drive.truth[i - 1].T_world_base.translation()).norm();
  return drive;
}

TEST(StartOnTheMove, ItIsHonestBeforeAndAfterItKnowsTheGyrosBias) {
  constexpr double kTimes[] = {5.0, 15.0, 23.0, 31.0, 39.0};  // s; at 31 it has just stood
  const base::EkfConfig config = true_config();
  std::array<double, std::size(kTimes)> pose = {};
  for (unsigned run = 0; run < kRuns; ++run) {
    DriveOptions options = drawn(config, run);
    options.stand_first = -4.0;
    const Drive drive = simulate_drive(options, config.vehicle);
    Filter filter(config);
    run_and_look(filter, drive, kTimes, [&](std::size_t k, const model::Estimate& e, std::size_t start) {
      pose[k] += pose_nees(e, drive, start) / kRuns;
    });
    ASSERT_EQ(filter.counters()["starts.moving"], 1);
  }
  for (std::size_t k = 0; k < std::size(kTimes); ++k) {
    std::printf("[ figure ] started on the move, NEES of the pose at %.0f s: %.2f (expected 6)\n", kTimes[k], pose[k]);
    EXPECT_LT(pose[k], kHigh6);
    if (k > 0) {  // a start on the move is worth more than it claims: its speed is taken to be 0.5 m/s off
      EXPECT_GT(pose[k], kLow6);
    }
  }
}

TEST(StartOnTheMove, ItStaysWithinOnePercentInTheTownWithSlips) {
  const base::EkfConfig config;
  double mean = 0.0;
  double worst = 0.0;
  constexpr unsigned kDrives = 10;
  for (unsigned k = 0; k < kDrives; ++k) {
    TownDriveOptions options;
    options.seed = 2000 + k;
    options.seconds = 120.0;
    const Drive drive = without_beginning(simulate_town_drive(options, config.vehicle), 8.0);  // at 3 m/s by then
    Filter filter(config);
    const auto out = run(filter, drive);
    ASSERT_EQ(filter.counters()["starts.moving"], 1);
    const double error = end_error(out, drive);
    mean += error / kDrives;
    worst = std::max(worst, error);
    for (std::size_t i = 1; i < out.size(); ++i) {  // and odom is continuous: it moves as its own twist says
      const Pose step = out[i - 1].T_odom_base.inverse() * out[i].T_odom_base;
      const double dt = base::seconds_between(out[i - 1].utime, out[i].utime);
      ASSERT_LT((step.translation() - dt * out[i].velocity).norm(), 2e-3 + 0.03 * dt * out[i].velocity.norm());
      ASSERT_LT(std::abs(roll_pitch_yaw(step.linear()).z() - dt * out[i].angular_rate.z()), 1e-3);
      if (out[i].stationary && out[i - 1].stationary) {
        ASSERT_LT(step.translation().norm(), 1e-9);
      }
    }
  }
  std::printf("[ figure ] started on the move, with slips, end error: mean %.2f %%, worst %.2f %% of 265 m\n",
              100.0 * mean, 100.0 * worst);
  EXPECT_LT(worst, 0.01);
}

}  // namespace
}  // namespace curbstone::ekf::filter
