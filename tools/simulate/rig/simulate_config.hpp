#pragma once

#include "common/config/config.hpp"
#include "common/config/vehicle.hpp"
#include "tools/simulate/paint/painted_ground.hpp"
#include "tools/simulate/sensors/imu_model.hpp"
#include "tools/simulate/sensors/intensity_model.hpp"
#include "tools/simulate/sensors/lidar_noise.hpp"
#include "tools/simulate/sensors/wheel_model.hpp"

namespace curbstone::simulate::rig {

/// Section `simulate:` of the vehicle's file.
struct SimulateConfig {
  VehicleConfig vehicle;
  double rpm = 1200;          ///< of the LiDAR
  double speed = 3.0;         ///< m/s
  double standstill = 4.0;    ///< s at the start
  double acceleration = 0.9;  ///< m/s^2
  bool manoeuvres = false;    ///< at the stops
  double steepness = 0.04;    ///< of the ground
  paint::Paint paint = paint::Paint::kFresh;
  sensors::IntensityModel intensity;
  sensors::LidarNoise lidar;
  sensors::ImuNoise imu;
  sensors::WheelNoise wheels;

  void visit(ConfigVisitor& v) {
    v.section("vehicle", vehicle, "extrinsics and wheels, as the vehicle's own processes have them");
    v.field("rpm", rpm, {300.0, 1200.0}, "1/min, of the LiDAR");
    v.field("speed", speed, {0.2, 15.0}, "m/s, in the town");
    v.field("standstill", standstill, {0.0, 60.0}, "s at the start, for the IMU to be levelled");
    v.field("acceleration", acceleration, {0.1, 5.0}, "m/s^2, at most");
    v.field("manoeuvres", manoeuvres, "at its stops in the town it backs up, turns on the spot, goes a leg backwards");
    v.field("steepness", steepness, {0.0, 0.5}, "of the ground in the town, at most; a crossfall comes on top");
    using enum paint::Paint;
    v.choice("paint", paint, {{"none", kNone}, {"fresh", kFresh}, {"worn", kWorn}}, "on the streets of the town");
    v.field("ring_gains", intensity.ring_gains, "every laser has a scale of intensity of its own, in the town");
    v.field("intensity_step", intensity.step, {1.0, 64.0}, "of 255, what intensities are multiples of, in the town");
    v.section("lidar", lidar, "the LiDAR's errors");
    v.section("imu", imu, "the IMU's errors");
    v.section("wheels", wheels, "the wheels' errors");
  }
};

}  // namespace curbstone::simulate::rig
