#pragma once

#include <sys/types.h>

#include <cstdint>
#include <map>
#include <procman_lcm/cmd_status_t.hpp>
#include <procman_lcm/deputy_info_t.hpp>

#include "procman/process/process_table.hpp"

namespace curbstone::procman::process {

/// Fills in the CPU and memory fields of PM_INFO. CPU is a fraction of the whole machine between two samples, 0..1.
class UsageMeter {
 public:
  /// Samples the machine; call it once per round, before measure().
  void sample(procman_lcm::deputy_info_t& info);
  /// Usage of a command's first process. `pid` 0 gives zeros. The first sample of a process has no CPU usage.
  void measure(pid_t pid, procman_lcm::cmd_status_t& status);

 private:
  MachineInfo machine_;
  std::int64_t ticks_passed_ = 0;
  std::map<pid_t, std::int64_t> ticks_;       // of the previous round
  std::map<pid_t, std::int64_t> next_ticks_;  // of this round
};

}  // namespace curbstone::procman::process
