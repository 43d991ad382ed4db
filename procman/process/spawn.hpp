#pragma once

#include <sys/types.h>

#include <string>

#include "procman/config/exec_line.hpp"
#include "procman/process/file_descriptor.hpp"

namespace curbstone::procman::process {

/// A process on its own pseudo-terminal (pty(7)). So its output is line-buffered. If the deputy is killed, the terminal
/// hangs up and the process gets SIGHUP.
struct SpawnedProcess {
  pid_t pid = 0;            ///< also its process group and its session
  FileDescriptor terminal;  ///< master side, non-blocking; reading gives stdout and stderr with "\r\n"
};

/// Starts `line` with this process's environment and `line.environment` over it. `mark` is put into the environment as
/// kMarkVariable, so that descendants can be recognised. Throws std::system_error when it cannot be executed.
[[nodiscard]] SpawnedProcess spawn(const config::ExecLine& line, const std::string& mark);

inline constexpr const char* kMarkVariable = "CURBSTONE_DEPUTY_MARK";

}  // namespace curbstone::procman::process
