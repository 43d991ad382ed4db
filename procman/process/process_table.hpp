#pragma once

#include <sys/types.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace curbstone::procman::process {

/// One process, from /proc/PID/stat (proc(5)).
struct ProcessInfo {
  pid_t pid = 0;
  pid_t parent = 0;
  pid_t session = 0;
  bool zombie = false;
  std::int64_t cpu_ticks = 0;        ///< user + system, in clock ticks
  std::int64_t memory_virtual = 0;   ///< bytes
  std::int64_t memory_resident = 0;  ///< bytes
};

/// Parses the text of /proc/PID/stat. A process's name may contain blanks and brackets.
[[nodiscard]] std::optional<ProcessInfo> parse_process_stat(const std::string& text);

/// Nothing if there is no such process.
[[nodiscard]] std::optional<ProcessInfo> read_process(pid_t pid);
[[nodiscard]] std::vector<ProcessInfo> read_process_table();

/// The living processes of a command: its first process `leader`, all processes of its session, all their descendants,
/// and orphans that this process has adopted as a subreaper and that carry `mark` in their environment.
[[nodiscard]] std::vector<pid_t> find_family(const std::vector<ProcessInfo>& table, pid_t leader,
                                             const std::string& mark);

/// CPU and memory of the whole machine, from /proc/stat and /proc/meminfo.
struct MachineInfo {
  std::int64_t cpu_ticks_total = 0;  ///< user + nice + system + idle of all cores since boot
  std::int64_t cpu_ticks_idle = 0;
  std::int64_t memory_total = 0;  ///< bytes
  std::int64_t memory_free = 0;
  std::int64_t swap_total = 0;
  std::int64_t swap_free = 0;
};
[[nodiscard]] MachineInfo read_machine();

}  // namespace curbstone::procman::process
