#pragma once

#include <curbstone/service_config_t.hpp>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/log/log_files.hpp"

namespace curbstone::replay {

/// What the processes of a drive were configured with, as its log has it in CONFIG.
struct RecordedConfig {
  std::string version;                          ///< of the first process that said so
  std::map<std::string, std::string> sections;  ///< of the vehicle's file, as YAML

  [[nodiscard]] bool empty() const { return sections.empty(); }
  void add(const service_config_t& message);
};

/// From the first seconds of a drive: a recorder writes what it knows at the head of each file, and each process says
/// it every 5 s.
[[nodiscard]] RecordedConfig recorded_config(LogFiles& files);

/// Nothing if the event is no CONFIG.
[[nodiscard]] std::optional<service_config_t> config_in(const LogEvent& event);

/// What two versions of a section set differently, one line each: "mapper.range: 60, recorded with 40". Values that a
/// replay sets itself (where it writes) are left out.
[[nodiscard]] std::vector<std::string> config_differences(const std::string& used, const std::string& recorded);

}  // namespace curbstone::replay
