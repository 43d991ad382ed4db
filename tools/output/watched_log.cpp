#include "tools/output/watched_log.hpp"

#include <fmt/format.h>

#include <cstdio>

namespace curbstone::output {

WatchedLog::WatchedLog(const std::vector<std::string>& paths, const std::string& command)
    : files_(paths), command_(command), bar_(command) {}

std::optional<LogEvent> WatchedLog::next() {
  std::optional<LogEvent> event = files_.next();
  if (!event) {
    bar_.reset();
    say_notes();
    return event;
  }
  if (!begin_) begin_ = event->log_utime;
  if (bar_ && bar_->is_due()) {
    bar_->show(files_.progress(),
               fmt::format("{:.1f} s of drive", static_cast<double>(event->log_utime - *begin_) * 1e-6));
  }
  return event;
}

void WatchedLog::say_notes() {
  if (said_) return;
  said_ = true;
  for (const std::string& note : files_.notes()) fmt::print(stderr, "curbstone {}: {}\n", command_, note);
}

}  // namespace curbstone::output
