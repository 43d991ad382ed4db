#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "services/ekf/filter/filter.hpp"
#include "services/ekf/state/state_file.hpp"
#include "tests/services/ekf/simulated_drive.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::ekf::filter {
namespace {

constexpr double kOneDegree = M_PI / 180.0;
constexpr double kSetOff = 2.0;  // s
constexpr double kDown = 0.4;    // s until the deputy has started the next one

Drive setting_off() {
  DriveOptions o;
  o.seconds = 14.0;
  o.stand_first = kSetOff;
  o.stop_at = 1e9;
  o.gyro_bias << 0.004, -0.006, 0.008;
  o.accelerometer_bias << 0.03, -0.02, 0.04;
  o.wheel_speed_noise = 0.01;
  return simulate_drive(o, base::EkfConfig{}.vehicle);
}

/// Runs a filter over [from, to) s of the drive.
void drive_on(Filter& filter, const Drive& drive, double from, double to, std::vector<model::Estimate>& out) {
  const auto seconds = [&](std::int64_t utime) { return base::seconds_between(drive.imu.front().utime, utime); };
  std::size_t w = 0;
  for (const base::ImuSample& imu : drive.imu) {
    for (; w < drive.wheels.size() && drive.wheels[w].utime <= imu.utime; ++w)
      if (seconds(drive.wheels[w].utime) >= from && seconds(imu.utime) < to) filter.add(drive.wheels[w], out);
    if (seconds(imu.utime) >= from && seconds(imu.utime) < to) filter.add(imu, out);
  }
}

/// Of what says that it may be used.
struct Worst {
  double tilt = 0.0;          // rad
  double swing = 0.0;         // rad from one estimate to the next, more than the vehicle's own
  double speed = 0.0;         // m/s
  double usable_after = 1e9;  // s of the restart
};

Worst worst_of(const std::vector<model::Estimate>& estimates, const Drive& drive, double restart) {
  Worst worst;
  std::optional<Eigen::Vector3d> before;
  for (const model::Estimate& e : estimates) {
    if (!e.level) continue;
    const TruePose& truth = drive.truth[drive.index_of(e.utime)];
    const Eigen::Vector3d error = roll_pitch_yaw(e.T_odom_base.linear()) - roll_pitch_yaw(truth.T_world_base.linear());
    worst.usable_after =
        std::min(worst.usable_after, base::seconds_between(drive.imu.front().utime, e.utime) - restart);
    worst.tilt = std::max(worst.tilt, error.head<2>().norm());
    if (before) worst.swing = std::max(worst.swing, (error - *before).head<2>().norm());
    worst.speed = std::max(worst.speed, std::abs(e.velocity.x() - truth.velocity.x()));
    before = error;
  }
  return worst;
}

class KilledFilterTest : public ::testing::Test {
 protected:
  test::TemporaryFolder folder_;
  std::string file_ = folder_ / "ekf.state";
  base::EkfConfig config_;
  Drive drive_ = setting_off();
};

TEST_F(KilledFilterTest, TheNextOneGoesOnWhereverItsPredecessorWasKilled) {
  for (double kill = kSetOff - 0.75; kill < kSetOff + 1.6; kill += 0.25) {
    std::vector<model::Estimate> estimates;
    Filter killed(config_);
    drive_on(killed, drive_, 0.0, kill, estimates);
    ASSERT_TRUE(state::save_state(file_, killed.belief()));
    estimates.clear();
    Filter next(config_);
    next.inherit(*state::load_state(file_));
    drive_on(next, drive_, kill + kDown, 14.0, estimates);
    EXPECT_EQ(next.counters()["starts.inherited"], 1);
    const Worst worst = worst_of(estimates, drive_, kill + kDown);
    EXPECT_LT(worst.usable_after, 2.0) << kill;
    EXPECT_LT(worst.tilt, 0.7 * kOneDegree) << kill;
    EXPECT_LT(worst.speed, 0.15) << kill;
  }
}

/// What it turns while no process runs is lost for good: no measurement corrects the heading.
TEST_F(KilledFilterTest, TheNextOneKeepsItsHeadingInABend) {
  DriveOptions o;
  o.seconds = 14.0;
  o.stand_first = kSetOff;
  o.stop_at = 1e9;
  o.gyro_bias << 0.004, -0.006, 0.008;
  const Drive drive = simulate_drive(o, config_.vehicle);
  const auto heading_error = [&](const model::Estimate& e) {
    return roll_pitch_yaw(e.T_odom_base.linear()).z() -
           roll_pitch_yaw(drive.truth[drive.index_of(e.utime)].T_world_base.linear()).z();
  };
  double most = 0.0, turned = 0.0, later = 0.0;
  for (double kill = kSetOff + 2.0; kill < 13.0; kill += 0.5) {
    std::vector<model::Estimate> estimates;
    Filter killed(config_);
    drive_on(killed, drive, 0.0, kill, estimates);
    const double before = heading_error(estimates.back());
    const std::int64_t died = estimates.back().utime;
    estimates.clear();
    Filter next(config_);
    next.inherit(killed.belief());
    drive_on(next, drive, kill + kDown, kill + kDown + 0.1, estimates);
    most = std::max(most, std::abs(heading_error(estimates.front()) - before));
    const auto yaw_at = [&](std::int64_t utime) {
      return roll_pitch_yaw(drive.truth[drive.index_of(utime)].T_world_base.linear()).z();
    };
    turned = std::max(turned, std::abs(yaw_at(estimates.front().utime) - yaw_at(died)));
    const double at_first = heading_error(estimates.back());
    drive_on(next, drive, kill + kDown + 0.1, 14.0, estimates);
    later = std::max(later, std::abs(heading_error(estimates.back()) - at_first));
  }
  EXPECT_GT(turned, 5.0 * kOneDegree) << "the drive has bends";
  EXPECT_LT(most, 1.5 * kOneDegree);
  EXPECT_LT(later, 0.2 * kOneDegree) << "roll and pitch that settle leave the heading as it is";
}

TEST_F(KilledFilterTest, OneThatStartsOnTheMoveIsNotUsedUntilItIsLevel) {
  for (double kill = kSetOff - 0.75; kill < kSetOff + 1.6; kill += 0.25) {
    std::vector<model::Estimate> estimates;
    Filter next(config_);
    drive_on(next, drive_, kill + kDown, 14.0, estimates);
    EXPECT_EQ(next.counters()["starts.moving"], 1) << kill;
    EXPECT_FALSE(estimates.front().level) << kill;
    const Worst worst = worst_of(estimates, drive_, kill + kDown);
    EXPECT_LT(worst.swing, 0.3 * kOneDegree) << kill;
    EXPECT_LT(worst.usable_after, 10.1) << kill;
  }
}

/// The encoder was killed too, and is a period wrong about when its first sample was taken.
TEST_F(KilledFilterTest, AFirstWheelSampleThatIsStampedWrongDoesNotLeadItAstray) {
  constexpr double kFirst = 8.0;  // s, in mid-drive
  std::vector<model::Estimate> estimates;
  Filter killed(config_);
  drive_on(killed, drive_, 0.0, kFirst - kDown, estimates);
  for (const double periods : {0.2, 0.5, 1.0, 2.0}) {
    for (const bool goes_on : {false, true}) {
      Drive drive = drive_;
      const auto first = std::find_if(drive.wheels.begin(), drive.wheels.end(), [&](const base::WheelSample& w) {
        return base::seconds_between(drive.imu.front().utime, w.utime) >= kFirst;
      });
      const std::array<double, 2> next = std::next(first)->angle;
      for (std::size_t i = 0; i < 2; ++i) first->angle[i] -= periods * (next[i] - first->angle[i]);
      estimates.clear();
      Filter filter(config_);
      if (goes_on) filter.inherit(killed.belief());
      drive_on(filter, drive, kFirst, 14.0, estimates);
      const Worst worst = worst_of(estimates, drive, kFirst);
      EXPECT_LT(worst.usable_after, 5.0) << periods << goes_on;
      EXPECT_LT(worst.tilt, 2.0 * kOneDegree) << periods << goes_on;
      EXPECT_LT(worst.speed, 0.3) << periods << goes_on;
    }
  }
}

/// They spin while it is levelled by them.
TEST_F(KilledFilterTest, OneThatWasLevelledByWheelsThatSpanFindsItWithinTwoSeconds) {
  constexpr double kFirst = 8.0, kSpun = 0.7;  // s
  std::vector<model::Estimate> estimates;
  Filter killed(config_);
  drive_on(killed, drive_, 0.0, kFirst - kDown, estimates);
  for (const double share : {0.2, 0.3, 0.5}) {
    Drive drive = drive_;
    std::array<double, 2> before = {};
    std::array<double, 2> more = {};
    for (base::WheelSample& w : drive.wheels) {
      const double t = base::seconds_between(drive.imu.front().utime, w.utime);
      for (std::size_t i = 0; i < 2; ++i) {
        if (t > kFirst && t < kFirst + kSpun) more[i] += share * (w.angle[i] - before[i]);
        before[i] = w.angle[i];
        w.angle[i] += more[i];
      }
    }
    estimates.clear();
    Filter filter(config_);
    filter.inherit(killed.belief());
    drive_on(filter, drive, kFirst, 14.0, estimates);
    std::erase_if(estimates, [&](const model::Estimate& e) {
      return base::seconds_between(drive.imu.front().utime, e.utime) < kFirst + kSpun + 2.0;
    });
    const Worst worst = worst_of(estimates, drive, kFirst);
    EXPECT_LT(worst.usable_after, 5.0) << share;
    EXPECT_LT(worst.speed, 0.15) << share;
    EXPECT_LT(worst.tilt, 1.0 * kOneDegree) << share;
  }
}

TEST_F(KilledFilterTest, WhatIsTooOldOrDoesNotFitIsNotInherited) {
  std::vector<model::Estimate> estimates;
  Filter killed(config_);
  drive_on(killed, drive_, 0.0, 5.0, estimates);
  const model::Belief good = killed.belief();
  model::Belief old = good;
  old.utime -= 2'000'000;
  model::Belief ahead = good;
  ahead.utime += 3'000'000;
  model::Belief rolled_over = good;
  rolled_over.mean.attitude = Eigen::Quaterniond(Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitX()));
  for (const model::Belief& bad : {old, ahead, rolled_over}) {
    Filter next(config_);
    next.inherit(bad);
    drive_on(next, drive_, 5.4, 8.0, estimates);
    EXPECT_EQ(next.counters()["starts.not_inherited"], 1);
    EXPECT_EQ(next.counters()["starts.moving"], 1);
  }
}

TEST_F(KilledFilterTest, AFileSaysExactlyWhatWasBelieved) {
  std::vector<model::Estimate> estimates;
  Filter filter(config_);
  drive_on(filter, drive_, 0.0, 6.0, estimates);
  ASSERT_TRUE(state::save_state(file_, filter.belief()));
  const auto loaded = state::load_state(file_);
  ASSERT_TRUE(loaded);
  EXPECT_EQ(loaded->utime, filter.belief().utime);
  EXPECT_EQ(loaded->covariance, filter.belief().covariance);
  EXPECT_TRUE(minus(loaded->mean, filter.belief().mean).isZero(1e-12));
}

TEST_F(KilledFilterTest, ADamagedFileIsNone) {
  EXPECT_FALSE(state::load_state(file_)) << "there is none";
  EXPECT_FALSE(state::save_state(folder_ / "no" / "ekf.state", model::Belief{}));
  std::vector<model::Estimate> estimates;
  Filter filter(config_);
  drive_on(filter, drive_, 0.0, 3.0, estimates);
  ASSERT_TRUE(state::save_state(file_, filter.belief()));
  std::ifstream in(file_, std::ios::binary);
  const std::string good(std::istreambuf_iterator<char>(in), {});
  const auto write = [&](const std::string& bytes) { std::ofstream(file_, std::ios::binary) << bytes; };
  for (std::size_t i = 0; i < good.size(); i += 7) {
    std::string bad = good;
    bad[i] = static_cast<char>(bad[i] ^ 0x10);
    write(bad);
    EXPECT_FALSE(state::load_state(file_)) << "byte " << i;
  }
  for (const std::size_t size : {std::size_t{0}, std::size_t{8}, good.size() - 1}) {
    write(good.substr(0, size));
    EXPECT_FALSE(state::load_state(file_));
  }
  write(good + "x");
  EXPECT_FALSE(state::load_state(file_));
}

}  // namespace
}  // namespace curbstone::ekf::filter
