#pragma once

#include <optional>
#include <string>

#include "tools/doctor/checks/vehicle_checks.hpp"

namespace curbstone::doctor::facts {

/// What the vehicle's files ask for.
struct VehicleWishes {
  checks::VehicleFacts facts;     ///< configs, programs, folders, devices, CAN
  std::optional<int> lidar_port;  ///< UDP; nothing where a file stands for the device
  std::string lidar_address;      ///< of the device; empty: any
  std::string recorder_folder;
  std::string unrecorded_channel;  ///< one that the recorder leaves out; empty: none
};

/// Reads `config_file` (YAML) and `procman_file`, and looks for what they name. Of a section that cannot be used the
/// defaults are looked for.
[[nodiscard]] VehicleWishes read_vehicle(const std::string& config_file, const std::string& procman_file);

/// Of the file system that holds `folder`, without the rate. Nothing if it is not there.
[[nodiscard]] std::optional<checks::DiskFacts> read_disk(const std::string& folder);

}  // namespace curbstone::doctor::facts
