#pragma once

#include <vector>

#include "tools/bench/sensor_faults/catalogue/fault.hpp"

namespace curbstone::bench::sensor_faults::catalogue {

/// Section `vehicle` of the vehicle's file says wrongly where the sensors are and how large the wheels are. The sensors
/// of the drive are where the default VehicleConfig has them.
[[nodiscard]] std::vector<Fault> vehicle_file_faults();
/// Encoders that are wired or set up wrongly, that fail or stall, and wheels that slip.
[[nodiscard]] std::vector<Fault> wheel_faults();
/// An IMU in other units or axes than it should be, a gyro that fails, vibration, wrong stamps.
[[nodiscard]] std::vector<Fault> imu_faults();
/// Wrong scales, leaps, clipping and gaps of an IMU.
[[nodiscard]] std::vector<Fault> imu_range_faults();
/// A LiDAR that is loose on its mount or was knocked.
[[nodiscard]] std::vector<Fault> lidar_mount_faults();
/// Wrong stamps and numbers of its messages, and gaps.
[[nodiscard]] std::vector<Fault> lidar_stamp_faults();
/// Packets that are lost or come again; devices that start again with another clock.
[[nodiscard]] std::vector<Fault> lidar_packet_faults();
/// Single lasers that fail, and tables of lasers that are another device's.
[[nodiscard]] std::vector<Fault> lidar_laser_faults();
/// Rain, a wet road, dust, sun, a car wash.
[[nodiscard]] std::vector<Fault> weather_faults();
/// Wrong ranges, lasers, intensities.
[[nodiscard]] std::vector<Fault> lidar_return_faults();
/// Points that are missing, or that nothing is at: weather, dirt, glass.
[[nodiscard]] std::vector<Fault> lidar_sight_faults();
/// The clock that stamps all sensors' messages is set in mid-drive: no sensor is wrong, and none is wrong alone.
[[nodiscard]] std::vector<Fault> host_clock_faults();
/// Another device of the kind publishes on a sensor's channel: a second driver, or another vehicle on the bus.
[[nodiscard]] std::vector<Fault> second_sender_faults();
/// What moves with the vehicle or beside it and hides the street, and ground that turns: no sensor is
/// wrong.
[[nodiscard]] std::vector<Fault> surroundings_faults();
/// Drives of vehicles and drivers that differ from the common one, in which nothing is wrong.
[[nodiscard]] std::vector<Fault> faultless_drives();

}  // namespace curbstone::bench::sensor_faults::catalogue
