#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

typedef struct _lcm_eventlog_t lcm_eventlog_t;

namespace curbstone {

/// One message of a log.
struct LogEvent {
  std::int64_t log_utime = 0;  ///< us since the Unix epoch, when the logger received it
  std::string channel;
  std::vector<std::uint8_t> bytes;
};

/// Reads an `lcm-logger` log from beginning to end. Format: lcm/lcm/eventlog.c. One thread.
class LogReader {
 public:
  /// Throws std::runtime_error with one clear line: the file is missing, unreadable, or no LCM log.
  explicit LogReader(const std::string& file);
  ~LogReader();
  LogReader(const LogReader&) = delete;
  LogReader& operator=(const LogReader&) = delete;

  /// The next event; nothing at the end. A log that was cut off inside an event ends there: see truncated().
  [[nodiscard]] std::optional<LogEvent> next();
  [[nodiscard]] bool truncated() const { return truncated_; }
  /// Where the last whole event ended, and how many bytes behind it were not read: fewer than an event if the log was
  /// cut off, more if it is damaged there.
  [[nodiscard]] std::int64_t read_to() const { return read_to_; }
  [[nodiscard]] std::int64_t unread() const { return size_ - read_to_; }
  /// The part of the file read so far, 0..1.
  [[nodiscard]] double progress() const;

 private:
  lcm_eventlog_t* log_ = nullptr;
  std::int64_t size_ = 0;
  std::int64_t read_to_ = 0;
  bool truncated_ = false;
};

}  // namespace curbstone
