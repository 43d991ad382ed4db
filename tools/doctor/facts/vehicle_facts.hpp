#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tools/doctor/checks/vehicle_checks.hpp"

namespace curbstone::doctor::facts {

/// What the vehicle's files name and require.
struct VehicleWishes {
  checks::VehicleFacts facts;     ///< configs, programs, folders, devices, CAN
  std::optional<int> lidar_port;  ///< UDP; empty if the device is a file
  std::string lidar_address;      ///< of the device; empty: any
  std::string recorder_folder;
  std::string unrecorded_channel;  ///< excluded from recordings; empty: none
  /// Of the settings that the files give each service now, by its name on the bus. Left out are services whose settings
  /// the files do not tell: started by a shell, or from another file.
  std::map<std::string, std::string> config_hashes;
};

/// The services in `running`, by name, whose hash is another one than the files give them.
[[nodiscard]] std::vector<checks::StaleService> stale_services(const VehicleWishes& wishes, const std::string& file,
                                                               const std::map<std::string, std::string>& running);

/// Reads `config_file` (YAML) and `procman_file`, and checks what they name. For an invalid section the defaults are
/// checked.
[[nodiscard]] VehicleWishes read_vehicle(const std::string& config_file, const std::string& procman_file);

/// The file system that holds `folder`, without the rate. Empty if the folder does not exist.
[[nodiscard]] std::optional<checks::DiskFacts> read_disk(const std::string& folder);

}  // namespace curbstone::doctor::facts
