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
  int terminal = 0;  ///< device number of the controlling terminal, as the kernel packs it; 0: none
  bool zombie = false;
  std::int64_t cpu_ticks = 0;        ///< user + system, in clock ticks
  std::int64_t start_ticks = 0;      ///< of the start, in clock ticks since boot
  std::int64_t memory_virtual = 0;   ///< bytes
  std::int64_t memory_resident = 0;  ///< bytes
};

/// Parses the text of /proc/PID/stat. A process's name may contain blanks and brackets.
[[nodiscard]] std::optional<ProcessInfo> parse_process_stat(const std::string& text);

/// Nothing if there is no such process.
[[nodiscard]] std::optional<ProcessInfo> read_process(pid_t pid);
[[nodiscard]] std::vector<ProcessInfo> read_process_table();

/// The living processes of a command: its first process `leader`, all processes of its session, all their descendants,
/// and orphans that carry `mark` in their environment and whose parent is this process, a subreaper, or `reaper`: that
/// of a leader which an earlier deputy has started.
[[nodiscard]] std::vector<pid_t> find_family(const std::vector<ProcessInfo>& table, pid_t leader,
                                             const std::string& mark, pid_t reaper = 0);

/// The mark that the process was started with, from its environment; empty if it has none.
[[nodiscard]] std::string read_mark(pid_t pid);

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
