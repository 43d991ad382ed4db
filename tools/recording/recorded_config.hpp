#pragma once

#include <curbstone/service_config_t.hpp>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/config/config.hpp"
#include "common/config/vehicle.hpp"
#include "common/log/log_files.hpp"
#include "config/sections.hpp"

namespace curbstone::recording {

/// The configuration of a drive's processes, from CONFIG in its log.
struct RecordedConfig {
  std::string version;                          ///< of the first process that published it
  std::map<std::string, std::string> sections;  ///< of the vehicle's file, as YAML

  [[nodiscard]] bool empty() const { return sections.empty(); }
  void add(const service_config_t& message);
  /// The vehicle as the mapper knew it; if that was not recorded, as another process did; else the defaults. Throws
  /// ConfigError.
  [[nodiscard]] VehicleConfig vehicle() const;
  /// Loads a process's section. If it was not recorded, vehicle() remains, which the processes share. Throws
  /// ConfigError.
  void load(const std::string& section, AnyConfig& config) const;
};

/// The configuration of a process: its section of `file` or, without a file, what was recorded (else the defaults), and
/// then the assignments SECTION.KEY=VALUE for its section. Throws ConfigError.
template <class Config>
[[nodiscard]] ConfigOf<Config> config_of(const std::string& section, const std::string& file,
                                         const RecordedConfig& recorded, const std::vector<std::string>& assignments) {
  ConfigOf<Config> config;
  if (file.empty()) {
    recorded.load(section, config);
  } else {
    load_config(file, section, kProcessSections, config);
  }
  set_section_values(section, assignments, config);
  return config;
}

/// The vehicle of `file` or, without a file, the recorded one. Throws ConfigError.
[[nodiscard]] VehicleConfig vehicle_of(const std::string& file, const RecordedConfig& recorded);

/// Where config_of() takes the values of these sections from, for people.
[[nodiscard]] std::string source_of_configuration(const std::vector<std::string>& sections, const std::string& file,
                                                  const RecordedConfig& recorded,
                                                  const std::vector<std::string>& assignments);

/// Reads the first seconds of a drive: a recorder writes the known configurations at the head of each file, and each
/// process publishes its own every 5 s.
[[nodiscard]] RecordedConfig recorded_config(LogFiles& files);

/// Empty if the event is not a CONFIG.
[[nodiscard]] std::optional<service_config_t> config_in(const LogEvent& event);

/// The differences between two versions of a section, one per line: "mapper.range: 60, recorded with 40". Values that a
/// replay sets itself (its output files) are left out.
[[nodiscard]] std::vector<std::string> config_differences(const std::string& used, const std::string& recorded);

}  // namespace curbstone::recording
