#pragma once

#include <sys/types.h>

#include <string>

#include "procman/config/exec_line.hpp"
#include "procman/process/file_descriptor.hpp"

namespace curbstone::procman::process {

/// A process on its own pseudo-terminal (pty(7)), which makes its output line-buffered. When nobody has its master side
/// open any more, because the deputy was killed, the terminal hangs up and the process gets SIGHUP.
struct SpawnedProcess {
  pid_t pid = 0;            ///< also the id of its process group and its session
  FileDescriptor terminal;  ///< master side, non-blocking; yields stdout and stderr with "\r\n"
};

/// Starts `line` with this process's environment, overridden by `line.environment`. `mark` is added to the environment
/// as kMarkVariable, so that descendants can be recognised. Throws std::system_error if it cannot be executed.
[[nodiscard]] SpawnedProcess spawn(const config::ExecLine& line, const std::string& mark);

inline constexpr const char* kMarkVariable = "CURBSTONE_DEPUTY_MARK";

}  // namespace curbstone::procman::process
