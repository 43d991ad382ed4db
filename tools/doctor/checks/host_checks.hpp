#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tools/doctor/checks/verdict.hpp"

namespace curbstone::doctor::checks {

/// The host's clock, as reported by adjtimex(2).
struct ClockFacts {
  bool is_synchronised = false;
  std::int64_t offset = 0;            ///< us, correction in progress in the kernel
  std::int64_t greatest_error = 0;    ///< us
  std::vector<std::string> programs;  ///< running programs that set the clock: chronyd, ptp4l, ...
};

struct ProcessorFacts {
  int cores = 0;         ///< available to this process
  std::string governor;  ///< of the first core; empty: unknown (a virtual machine)
  std::string driver;    ///< of the frequency scaling: "intel_pstate"
};

struct HostFacts {
  ClockFacts clock;
  ProcessorFacts processor;
};

[[nodiscard]] Verdicts check_host(const HostFacts& facts);

}  // namespace curbstone::doctor::checks
