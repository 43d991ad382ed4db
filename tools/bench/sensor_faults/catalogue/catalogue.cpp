#include "tools/bench/sensor_faults/catalogue/catalogue.hpp"

#include <regex>
#include <stdexcept>

#include "tools/bench/sensor_faults/catalogue/fault_lists.hpp"

namespace curbstone::bench::sensor_faults::catalogue {

std::vector<Fault> all_faults() {
  std::vector<Fault> all;
  for (auto* faults :
       {vehicle_file_faults, wheel_faults, imu_faults, imu_range_faults, lidar_mount_faults, lidar_stamp_faults,
        lidar_packet_faults, lidar_return_faults, lidar_laser_faults, lidar_sight_faults, weather_faults,
        host_clock_faults, second_sender_faults, surroundings_faults}) {
    for (Fault& fault : faults()) all.push_back(std::move(fault));
  }
  return all;
}

std::vector<Fault> named(std::vector<Fault> faults, const std::string& regex) {
  try {
    const std::regex wanted(regex, std::regex::extended);
    std::erase_if(faults, [&](const Fault& f) { return !std::regex_search(f.sensor + ": " + f.name, wanted); });
  } catch (const std::regex_error&) {
    throw std::runtime_error("'" + regex + "' is no regular expression");
  }
  if (faults.empty()) throw std::runtime_error("no name matches '" + regex + "'");
  return faults;
}

}  // namespace curbstone::bench::sensor_faults::catalogue
