#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "common/config/command_line.hpp"
#include "common/log/log_loss.hpp"
#include "common/log/log_reader.hpp"
#include "common/log/log_writer.hpp"

namespace curbstone::log_tool {

/// The options of every command that writes a log.
struct CopyOptions {
  std::vector<std::string> logs;
  std::string out;
  bool force = false;

  void declare(CommandLine& line);
};

/// Writes the events that `wanted` selects as a new log with records numbered from 0. Their bytes and times are
/// unchanged. `head`, if given, writes before the first of them, at whose time (us) it is called. Reports on stdout
/// what it wrote, on stderr what was lost. Returns the loss.
LogLoss copy_log(const CopyOptions& options, const std::string& command,
                 const std::function<bool(const LogEvent&)>& wanted,
                 const std::function<void(LogWriter&, std::int64_t utime)>& head = nullptr);

}  // namespace curbstone::log_tool
