#pragma once

#include <sys/types.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "procman/config/config.hpp"
#include "procman/process/spawn.hpp"

namespace curbstone::procman::process {

/// What a later deputy must know of a running command to recognise it. Its text is the name of the command's terminal
/// where that is kept meanwhile.
struct RunningCommand {
  pid_t pid = 0;
  std::int64_t start_ticks = 0;  ///< with the pid, names one process since boot
  std::int32_t run_id = 0;       ///< by which a sheriff knows this run
  std::uint64_t digest = 0;      ///< digest_of() the command
};
[[nodiscard]] std::string to_text(const RunningCommand& command);
[[nodiscard]] std::optional<RunningCommand> parse_running_command(const std::string& text);

/// Over what decides what a start of the command runs: its id, its words after replacing variables, the bus and the
/// vehicle's file. Commands of one digest are the same.
[[nodiscard]] std::uint64_t digest_of(const config::Command& command);

/// A process that an earlier deputy started and that still runs.
struct AdoptedProcess {
  SpawnedProcess process;
  FileDescriptor end;        ///< pidfd: readable when the process has ended. Nobody learns its exit status
  std::string mark;          ///< of its descendants
  pid_t reaper = 0;          ///< parent of it, and of what it orphans
  std::int64_t started = 0;  ///< us of steady_clock()
};

/// Takes `terminal` if it is the controlling terminal of exactly this process, as the leader of its session.
[[nodiscard]] std::optional<AdoptedProcess> recognise(const RunningCommand& command, FileDescriptor& terminal);

/// The mark of all processes of a command that this deputy starts: its pid, the service manager that started it, the
/// id.
[[nodiscard]] std::string new_mark_of(const std::string& id);

/// The living processes of this control group that an earlier deputy of the same service manager started: those with
/// the mark of a process that does not live.
[[nodiscard]] std::vector<pid_t> find_leftovers();

}  // namespace curbstone::procman::process
