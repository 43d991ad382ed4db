#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/bench/faults/fault_report.hpp"
#include "tools/bench/faults/stack_drive.hpp"

namespace curbstone::bench::faults {

/// A row of the table: a fault injected into a drive.
struct Fault {
  std::string name;
  std::function<void(StackDrive&)> happen;  ///< injects it during the drive; may return before the end
  double seconds = 18;                      ///< of driving
  std::string simulate = {};                ///< more options of `curbstone simulate`
  int disk_mb = 0;                          ///< StackOptions
  Excuse excuse = {};
};

/// All rows, from no fault to the worst.
[[nodiscard]] std::vector<Fault> all_faults();

}  // namespace curbstone::bench::faults
