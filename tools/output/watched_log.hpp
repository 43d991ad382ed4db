#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/log/log_files.hpp"
#include "tools/output/progress_bar.hpp"

namespace curbstone::output {

/// Reads logs for a command: with a progress bar, and with a note on stderr at the end about what was damaged, missing
/// or duplicated in two files.
class WatchedLog {
 public:
  /// `command`: prefix of the notes, such as "replay". Throws as LogFiles does.
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
