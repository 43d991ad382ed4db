// The yaw of the IMU's mounting, measured each time a vehicle sets off: to a degree or two, whatever else is wrong.
#include "services/ekf/mounting/setting_off.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "tests/services/ekf/drawn_drives.hpp"
#include "tests/services/ekf/harmless_drives.hpp"
#include "tests/services/ekf/real_drives.hpp"
#include "tests/services/ekf/town_drive.hpp"

namespace curbstone::ekf::mounting {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

std::vector<SettingOff::Start> starts(const Drive& drive, const VehicleConfig& vehicle = VehicleConfig()) {
  SettingOff setting_off(vehicle);
  std::vector<SettingOff::Start> out;
  std::size_t w = 0;
  for (const base::ImuSample& imu : drive.imu) {
    for (; w < drive.wheels.size() && drive.wheels[w].utime <= imu.utime; ++w) {
      if (const auto start = setting_off.add(drive.wheels[w])) out.push_back(*start);
    }
    setting_off.add(imu);
  }
  return out;
}

Drive shaken_town(unsigned number, double speed, double vibration = 0.12) {
  const TownDriveOptions options{
      .seconds = 70, .speed = speed, .seed = 7000 + number, .town = number, .vibration = vibration};
  return simulate_town_drive(options, VehicleConfig());
}

/// As an IMU measures that is mounted with this yaw.
Drive with_yaw(Drive drive, double yaw) {
  const Eigen::Matrix3d R_imu_base = rotation_from_rpy(0, 0, yaw).transpose();
  for (base::ImuSample& sample : drive.imu) {
    sample.angular_rate = R_imu_base * sample.angular_rate;
    sample.acceleration = R_imu_base * sample.acceleration;
  }
  return drive;
}

TEST(SettingOff, ShowsTheYawOfTheMountingAtEachStart) {
  for (const unsigned number : {1U, 2U, 3U}) {
    for (const double speed : {0.7, 3.0, 5.0}) {
      const Drive drive = shaken_town(number, speed);
      for (const double yaw : {0.0, 20.0, -45.0, 90.0, -90.0, 180.0}) {
        const auto found = starts(with_yaw(drive, yaw * kDegree));
        ASSERT_FALSE(found.empty()) << number << ' ' << speed;
        for (const SettingOff::Start& start : found) {
          EXPECT_LT(std::abs(std::remainder(start.yaw - yaw * kDegree, 2 * std::numbers::pi)), 2 * kDegree) << yaw;
          EXPECT_TRUE(start.ahead);
        }
      }
    }
  }
}

TEST(SettingOff, TellsBackwardsByTheWheels) {
  Drive drive = shaken_town(1, 3.0);
  for (base::WheelSample& sample : drive.wheels) sample.angle = {-sample.angle[0], -sample.angle[1]};
  const auto found = starts(drive);
  ASSERT_FALSE(found.empty());
  EXPECT_FALSE(found.front().ahead);
  EXPECT_GT(std::abs(found.front().yaw), 178 * kDegree);
}

TEST(SettingOff, ShowsNoYawWhereRadiiTrackAndStampsAreWrongOrWheelsSpin) {  // long
  for (const HarmlessDrive& harmless : harmless_drives())
    for (const SettingOff::Start& start : starts(harmless.make()))
      EXPECT_LT(std::abs(start.yaw), 2 * kDegree) << harmless.name;
}

TEST(SettingOff, ShowsNoYawOfRecordedVehicles) {
  for (const std::string& name : real_drive_names()) {
    const auto drive = real_drive(name);
    if (!drive) GTEST_SKIP() << "the recording is not there";
    for (const SettingOff::Start& start : starts(drive->drive, drive->vehicle))
      EXPECT_LT(std::abs(start.yaw), 2 * kDegree) << name;
  }
}

/// Wheels that spin from the start on, each otherwise, with radii and a track that are wrong.
TEST(SettingOff, ShowsNoYawWhereWheelsSpinFromTheStart) {
  std::size_t judged = 0;
  for (unsigned seed = 1; seed <= 30; ++seed) {
    std::mt19937 random(seed);
    const auto between = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
    DriveOptions o = drawn_uncalibrated(random);
    o.seed = seed;
    o.seconds = 15;
    o.slip_begin = between(1.0, 4.0);
    o.slip_end = o.slip_begin + between(0.5, 10.0);
    o.slip_left = between(-0.3, 0.6);
    o.slip_right = between(-0.3, 0.6);
    const auto found = starts(simulate_drive(o, VehicleConfig()));
    judged += found.size();
    for (const SettingOff::Start& start : found) EXPECT_LT(std::abs(start.yaw), 2 * kDegree) << seed;
  }
  EXPECT_GT(judged, 10U);
}

/// In towns from `first` to `last`. Its way is a random walk.
void expect_left_alone(unsigned first, unsigned last) {
  for (const double vibration : {0.5, 1.0, 3.0, 6.0}) {
    double worst = 0.0;
    std::size_t judged = 0;
    for (unsigned number = first; number <= last; ++number) {
      for (const SettingOff::Start& start : starts(shaken_town(number, 3.0, vibration))) {
        worst = std::max(worst, std::abs(start.yaw));
        ++judged;
      }
    }
    std::printf("[ figure ] vibration %.1f m/s^2: %zu starts judged, yaw up to %.1f deg\n", vibration, judged,
                worst / kDegree);
    EXPECT_LT(worst, 0.15) << vibration;
  }
}

TEST(SettingOff, AnImuThatShakesIsLeftAlone) {
  expect_left_alone(1, 3);
}

TEST(SettingOff, AnImuThatShakesIsLeftAloneInOtherTowns) {  // long
  expect_left_alone(4, 12);
}

}  // namespace
}  // namespace curbstone::ekf::mounting
