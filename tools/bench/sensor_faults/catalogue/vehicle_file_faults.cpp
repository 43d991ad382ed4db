#include "tools/bench/sensor_faults/catalogue/fault_lists.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>

#include "common/config/vehicle.hpp"
#include "tools/bench/sensor_faults/catalogue/points.hpp"

namespace curbstone::bench::sensor_faults::catalogue {

namespace {

enum Member : std::size_t { kX = 0, kY = 1, kZ = 2, kRoll = 3, kPitch = 4, kYaw = 5 };

Fault file_says(std::string name, std::string words, std::string setting) {
  Fault fault{"vehicle file", std::move(name), std::move(words), kFromTheBeginning};
  fault.settings = {std::move(setting)};
  return fault;
}

/// The file has `by` more, m or rad, of one of the LiDAR's six.
Fault lidar_at(std::string name, std::string words, Member member, double by) {
  std::vector<double> mount = VehicleConfig{}.lidar;
  mount[member] += by;
  return file_says(std::move(name), std::move(words), fmt::format("vehicle.lidar=[{}]", fmt::join(mount, ", ")));
}

Fault number(std::string name, std::string words, const char* key, double value) {
  return file_says(std::move(name), std::move(words), fmt::format("vehicle.{}={}", key, value));
}

}  // namespace

std::vector<Fault> vehicle_file_faults() {
  const VehicleConfig right;
  return {
      lidar_at("LiDAR yaw 10 deg", "the file turns the LiDAR by 10 deg about the vertical", kYaw, radians(10)),
      lidar_at("LiDAR yaw 90 deg", "the file turns the LiDAR by 90 deg about the vertical", kYaw, radians(90)),
      lidar_at("LiDAR yaw 180 deg", "the file has the LiDAR look back", kYaw, radians(180)),
      lidar_at("LiDAR pitch 3 deg", "the file has the LiDAR look down by 3 deg", kPitch, radians(3)),
      lidar_at("LiDAR roll 180 deg", "the file has the LiDAR upside down", kRoll, radians(180)),
      lidar_at("LiDAR 0.4 m too high", "the file has the LiDAR 0.4 m higher than it is", kZ, 0.4),
      lidar_at("LiDAR 0.4 m too low", "the file has the LiDAR 0.4 m lower than it is", kZ, -0.4),
      lidar_at("LiDAR 1 m too far ahead", "the file has the LiDAR 1 m further ahead than it is", kX, 1.0),
      lidar_at("LiDAR 1 m aside", "the file has the LiDAR 1 m further to the left than it is", kY, 1.0),
      number("track 10 % wide", "the file's track_width is 10 % too large", "track_width", 1.1 * right.track_width),
      number("track 10 % narrow", "the file's track_width is 10 % too small", "track_width", 0.9 * right.track_width),
      number("wheel radius 10 % large", "the file's wheel_radius is 10 % too large", "wheel_radius",
             1.1 * right.wheel_radius),
      number("wheel radius 10 % small", "the file's wheel_radius is 10 % too small", "wheel_radius",
             0.9 * right.wheel_radius),
  };
}

}  // namespace curbstone::bench::sensor_faults::catalogue
