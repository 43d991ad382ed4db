#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/log/file_window.hpp"
#include "common/log/log_loss.hpp"
#include "common/log/record_finder.hpp"

namespace curbstone {

/// One message of a log.
struct LogEvent {
  std::int64_t log_utime = 0;  ///< us since the Unix epoch, when the logger received it
  std::string channel;
  std::vector<std::uint8_t> bytes;
};

/// Reads an `lcm-logger` log from beginning to end. Format: lcm/lcm/eventlog.c. Damaged parts are skipped up to the
/// next record and counted: see loss(). One thread.
class LogReader {
 public:
  /// Throws std::runtime_error with one clear line: the file is missing, unreadable, or no LCM log.
  explicit LogReader(const std::string& file);

  /// The next event; nothing at the end.
  [[nodiscard]] std::optional<LogEvent> next();
  /// The parts that were skipped so far.
  [[nodiscard]] const LogLoss& loss() const { return loss_; }
  /// The fraction of the file read so far, 0..1.
  [[nodiscard]] double progress() const;

 private:
  [[nodiscard]] std::optional<LogRecord> next_record();
  void skip(const std::optional<LogRecord>& to);

  FileWindow file_;
  RecordFinder finder_;
  std::int64_t at_ = 0;
  std::optional<LogRecord> previous_;
  LogLoss loss_;
};

}  // namespace curbstone
