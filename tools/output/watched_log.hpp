#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/log/log_files.hpp"
#include "tools/output/progress_bar.hpp"

namespace curbstone::output {

/// Logs as a command reads them: with a progress bar, and with a word on stderr at the end on what was damaged, missing
/// or in two files at once.
class WatchedLog {
 public:
  /// `command` stands before what is said: "replay". Throws as LogFiles does.
  WatchedLog(const std::vector<std::string>& paths, const std::string& command);
  WatchedLog(const std::string& path, const std::string& command) : WatchedLog(std::vector{path}, command) {}

  [[nodiscard]] std::optional<LogEvent> next();
  [[nodiscard]] const LogFiles& files() const { return files_; }
  [[nodiscard]] bool damaged() const { return files_.loss().damaged(); }

 private:
  void say_notes();

  LogFiles files_;
  std::string command_;
  std::optional<ProgressBar> bar_;
  std::optional<std::int64_t> begin_;  // us
  bool said_ = false;
};

}  // namespace curbstone::output
