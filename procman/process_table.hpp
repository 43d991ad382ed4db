#pragma once

#include <sys/types.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace curbstone::procman {

/// One line of /proc.
struct ProcessInfo {
  pid_t pid = 0;
  pid_t parent = 0;
  pid_t session = 0;
  bool zombie = false;
  std::int64_t cpu_ticks = 0;        ///< user + system, in clock ticks
  std::int64_t memory_virtual = 0;   ///< bytes
  std::int64_t memory_resident = 0;  ///< bytes
};

/// Reads the text of /proc/PID/stat: a process's name may hold blanks and brackets.
[[nodiscard]] std::optional<ProcessInfo> parse_process_stat(const std::string& text);

/// Nothing when there is no such process.
[[nodiscard]] std::optional<ProcessInfo> read_process(pid_t pid);
[[nodiscard]] std::vector<ProcessInfo> read_process_table();

/// The living processes that belong to a command: its first process `leader`, everything in its session, everything
/// that descends from these, and orphans that this process (a subreaper) has adopted and that carry `mark`.
[[nodiscard]] std::vector<pid_t> find_family(const std::vector<ProcessInfo>& table, pid_t leader,
                                             const std::string& mark);

/// The whole machine.
struct MachineInfo {
  std::int64_t cpu_ticks_total = 0;  ///< user + nice + system + idle of all cores since boot
  std::int64_t cpu_ticks_idle = 0;
  std::int64_t memory_total = 0;  ///< bytes
  std::int64_t memory_free = 0;
  std::int64_t swap_total = 0;
  std::int64_t swap_free = 0;
};
[[nodiscard]] MachineInfo read_machine();

}  // namespace curbstone::procman
