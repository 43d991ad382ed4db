#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tools/doctor/checks/verdict.hpp"

namespace curbstone::doctor::checks {

/// The clock of the host, as adjtimex(2) has it.
struct ClockFacts {
  bool is_synchronised = false;
  std::int64_t offset = 0;            ///< us, that the kernel still corrects
  std::int64_t greatest_error = 0;    ///< us
  std::vector<std::string> programs;  ///< that run and set clocks: chronyd, ptp4l, ...
};

struct ProcessorFacts {
  int cores = 0;         ///< that this process may use
  std::string governor;  ///< of the first; empty: not known (a virtual machine)
  std::string driver;    ///< of its frequency: "intel_pstate"
};

struct HostFacts {
  ClockFacts clock;
  ProcessorFacts processor;
};

[[nodiscard]] Verdicts check_host(const HostFacts& facts);

}  // namespace curbstone::doctor::checks
