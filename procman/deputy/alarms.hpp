#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "procman/process/supervisor.hpp"

namespace curbstone::procman::deputy {

/// Faults of the commands, in words, for the deputy's own SERVICE_STATUS. Pure: time is an argument, us.
class Alarms {
 public:
  static constexpr std::int64_t kWindow = 60'000'000;  ///< us for which a death is remembered
  static constexpr std::size_t kCrashLoop = 5;         ///< deaths in that time that count as a crash loop

  /// A command has ended; `how` in words.
  void ended(const process::CommandState& state, const std::string& how, std::int64_t now);
  /// A command was silent for too long and is being replaced.
  void silent(const std::string& id, double seconds, std::int64_t now);

  /// One line per fault; empty if there are none. Also drops old events.
  [[nodiscard]] std::vector<std::string> faults(const std::vector<const process::CommandState*>& commands,
                                                std::int64_t now);

 private:
  struct Silence {
    double seconds = 0;
    std::int64_t at = 0;
  };
  struct History {
    std::vector<std::int64_t> deaths;  // us
    std::string how;                   // of the latest death
    Silence silence;
  };
  std::map<std::string, History> history_;
};

}  // namespace curbstone::procman::deputy
