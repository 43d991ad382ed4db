#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/bench/faults/stack_drive.hpp"

namespace curbstone::bench::faults {

/// A row of the table: what goes wrong in a drive.
struct Fault {
  std::string name;
  std::function<void(StackDrive&)> happen;  ///< during the drive; may return before its end
  double seconds = 18;                      ///< of driving
  std::string simulate = {};                ///< more options of `curbstone simulate`
  int disk_mb = 0;                          ///< StackOptions
};

/// All rows, from none to the worst.
[[nodiscard]] std::vector<Fault> all_faults();

}  // namespace curbstone::bench::faults
