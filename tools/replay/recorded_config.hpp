#pragma once

#include <curbstone/service_config_t.hpp>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/log/log_files.hpp"

namespace curbstone::replay {

/// The configuration of a drive's processes, from CONFIG in its log.
struct RecordedConfig {
  std::string version;                          ///< of the first process that published it
  std::map<std::string, std::string> sections;  ///< of the vehicle's file, as YAML

  [[nodiscard]] bool empty() const { return sections.empty(); }
  void add(const service_config_t& message);
};

/// Reads the first seconds of a drive: a recorder writes the known configurations at the head of each file, and each
/// process publishes its own every 5 s.
[[nodiscard]] RecordedConfig recorded_config(LogFiles& files);

/// Empty if the event is not a CONFIG.
[[nodiscard]] std::optional<service_config_t> config_in(const LogEvent& event);

/// The differences between two versions of a section, one per line: "mapper.range: 60, recorded with 40". Values that a
/// replay sets itself (its output files) are left out.
[[nodiscard]] std::vector<std::string> config_differences(const std::string& used, const std::string& recorded);

}  // namespace curbstone::replay
