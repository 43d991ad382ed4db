#include "tools/doctor/checks/host_checks.hpp"

#include <fmt/format.h>

#include <cstdlib>

namespace curbstone::doctor::checks {

namespace {

constexpr std::int64_t kMaxOffset = 50'000;  // us; at 20 m/s this shifts a map point by 1 m
constexpr int kMinCores = 2;

Verdict check_clock(const ClockFacts& clock) {
  const std::string who =
      clock.programs.empty() ? "no program sets it" : fmt::format("{}", fmt::join(clock.programs, ", "));
  if (!clock.is_synchronised) {
    return finding("clock", fmt::format("not synchronised ({})", who),
                   "apt-get install chrony, or ptp4l and phc2sys: docs/deployment.md, \"Clocks\"");
  }
  if (std::abs(clock.offset) > kMaxOffset) {
    return finding("clock",
                   fmt::format("{:+.1f} ms off its source ({})", static_cast<double>(clock.offset) * 1e-3, who),
                   "chronyc tracking; chronyc makestep, before the drive");
  }
  return good("clock",
              fmt::format("synchronised by {}: {:+} us, at most {} us wrong", who, clock.offset, clock.greatest_error));
}

/// intel_pstate and amd-pstate-epp reach full speed in "powersave" too; with other drivers the CPU stays at its lowest.
Verdict check_processor(const ProcessorFacts& processor) {
  if (processor.cores < kMinCores) {
    return finding("processor", fmt::format("{} core: the stack needs two", processor.cores),
                   "give it two: taskset -p 1 or the unit's CPUAffinity shows why");
  }
  if (processor.governor == "powersave" && processor.driver != "intel_pstate" && processor.driver != "amd-pstate-epp") {
    return finding("processor", "the governor powersave keeps the cores at their lowest speed",
                   "cpupower frequency-set -g performance");
  }
  return good("processor", fmt::format("{} cores{}", processor.cores,
                                       processor.governor.empty() ? "" : ", governor " + processor.governor));
}

}  // namespace

Verdicts check_host(const HostFacts& facts) {
  return {check_clock(facts.clock), check_processor(facts.processor)};
}

}  // namespace curbstone::doctor::checks
