#include "tools/calibrate/calibration.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/tools/calibrate/calibration_drive.hpp"

namespace curbstone::calibrate {
namespace {

std::array<double, kCalibratedCount> truth() {
  const VehicleConfig v = true_vehicle();
  std::array<double, kCalibratedCount> out = {v.wheel_radius, v.wheel_radius, v.track_width};
  std::copy_n(v.lidar.begin(), 6, out.begin() + 3);
  std::copy_n(v.imu.begin(), 6, out.begin() + 9);
  return out;
}

void print(const CalibrationResult& result) {
  for (std::size_t i = 0; i < kCalibratedCount; ++i) {
    const CalibratedValue& v = result.values[i];
    std::printf("[ figure ] %-18s error %8.5f sigma %8.5f %s%s\n", v.name.c_str(), v.value - truth()[i], v.sigma,
                v.unit.c_str(), v.observed ? "" : ", not observed");
  }
}

TEST(Calibration, AWindingDriveWithSlipsFindsWhatTheFileHasWrong) {
  const CalibrationResult result = calibrate(drive_to_calibrate(winding_motion(), 150.0, 1), believed_vehicle());
  print(result);
  const auto error = [&](Calibrated which) {
    return std::abs(result[which].value - truth()[static_cast<std::size_t>(which)]);
  };
  const VehicleConfig vehicle = true_vehicle();
  EXPECT_LT(error(Calibrated::kRadiusLeft), 0.001 * vehicle.wheel_radius);
  EXPECT_LT(error(Calibrated::kRadiusRight), 0.001 * vehicle.wheel_radius);
  EXPECT_LT(error(Calibrated::kTrack), 0.005 * vehicle.track_width);
  EXPECT_LT(error(Calibrated::kLidarYaw), 0.1 * M_PI / 180.0);
  EXPECT_LT(error(Calibrated::kLidarX), 0.01);
  EXPECT_LT(error(Calibrated::kLidarY), 0.01);
  for (const Calibrated which : {Calibrated::kRadiusLeft, Calibrated::kRadiusRight, Calibrated::kTrack,
                                 Calibrated::kLidarX, Calibrated::kLidarY, Calibrated::kLidarYaw})
    EXPECT_TRUE(result[which].observed) << result[which].name;
  // What it puts into the vehicle's file is what it observed, and no more.
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(result.vehicle.lidar[i],
              result.values[3 + i].observed ? result.values[3 + i].value : believed_vehicle().lidar[i]);
  }
}

TEST(Calibration, ErrorsAreWithinThreeOfTheirOwnSigma) {
  for (const std::uint64_t seed : {2U, 3U, 4U, 5U, 6U, 7U}) {
    const simulate::motion::Motion& motion = seed % 2 == 0 ? town_motion() : winding_motion();
    const CalibrationResult result = calibrate(drive_to_calibrate(motion, 120.0, seed), believed_vehicle());
    for (std::size_t i = 0; i < kCalibratedCount; ++i) {
      EXPECT_LT(std::abs(result.values[i].value - truth()[i]), 3.0 * result.values[i].sigma)
          << result.values[i].name << ", seed " << seed;
    }
  }
}

TEST(Calibration, ARollFoundInBendsToOneSideIsNoSurerThanTheCamberOfTheRoads) {
  const CalibrationResult result = calibrate(drive_to_calibrate(town_motion(), 120.0, 2), believed_vehicle());
  for (const Calibrated which : {Calibrated::kLidarRoll, Calibrated::kImuRoll}) {
    EXPECT_GT(result[which].sigma, 0.005) << result[which].name;
    EXPECT_LT(std::abs(result[which].value - truth()[static_cast<std::size_t>(which)]), 2.0 * result[which].sigma)
        << result[which].name;
  }
}

TEST(Calibration, AStraightDriveSaysNothingOfTheTrackAndTheLeverArms) {
  const CalibrationResult result = calibrate(drive_to_calibrate(straight_motion(), 60.0, 1), believed_vehicle());
  print(result);
  for (const Calibrated which : {Calibrated::kTrack, Calibrated::kLidarX, Calibrated::kLidarY, Calibrated::kImuX}) {
    EXPECT_FALSE(result[which].observed) << result[which].name;
    EXPECT_LT(result[which].share, 0.9) << result[which].name;
  }
  EXPECT_EQ(result.vehicle.track_width, believed_vehicle().track_width);
  EXPECT_EQ(result.vehicle.lidar[0], believed_vehicle().lidar[0]);
  EXPECT_EQ(result.vehicle.lidar[1], believed_vehicle().lidar[1]);
  // The radii it tells all the same, and where the LiDAR looks.
  EXPECT_TRUE(result[Calibrated::kRadiusLeft].observed);
  EXPECT_TRUE(result[Calibrated::kLidarYaw].observed);
  EXPECT_NEAR(result.vehicle.wheel_radius, true_vehicle().wheel_radius, 0.001 * true_vehicle().wheel_radius);
  bool track_is_open = false;
  for (const OpenDirection& direction : result.open)
    for (const auto& [name, part] : direction.parts) track_is_open = track_is_open || name == "track_width";
  EXPECT_TRUE(track_is_open);
}

TEST(Calibration, TooLittleIsSaid) {
  EXPECT_THROW((void)calibrate({}, VehicleConfig{}), std::runtime_error);
  CalibrationData standing = drive_to_calibrate(town_motion(), 4.0, 1);
  try {
    (void)calibrate(standing, VehicleConfig{});
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("0 pieces"));
  }
}

TEST(Calibration, GapsAndSensorsThatSayNothingSensibleCostAccuracyOnly) {
  CalibrationData data = drive_to_calibrate(town_motion(), 90.0, 5);
  const auto begin = static_cast<std::ptrdiff_t>(data.imu.size() / 3);
  data.imu.erase(data.imu.begin() + begin, data.imu.begin() + begin + 500);
  data.wheels.erase(data.wheels.begin() + 2 * begin, data.wheels.begin() + 2 * begin + 300);
  for (std::size_t i = 700; i < 715; ++i) data.lidar[i].T_map_lidar.translation().x() += 2.0;  // a map that jumped
  const CalibrationResult result = calibrate(data, believed_vehicle());
  EXPECT_NEAR(result[Calibrated::kRadiusLeft].value, true_vehicle().wheel_radius, 0.002 * true_vehicle().wheel_radius);
  EXPECT_NEAR(result[Calibrated::kTrack].value, true_vehicle().track_width, 0.01 * true_vehicle().track_width);
}

}  // namespace
}  // namespace curbstone::calibrate
