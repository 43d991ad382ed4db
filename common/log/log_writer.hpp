#pragma once

#include <cstdint>
#include <string>

typedef struct _lcm_eventlog_t lcm_eventlog_t;

namespace curbstone {

/// Writes an LCM log as lcm-logger does. If the records' times are the messages' own times, the file is a function of
/// the messages alone. One thread.
class LogWriter {
 public:
  /// Throws std::runtime_error when the file cannot be written.
  explicit LogWriter(const std::string& file);
  ~LogWriter();
  LogWriter(const LogWriter&) = delete;
  LogWriter& operator=(const LogWriter&) = delete;

  /// `log_utime`: us since the Unix epoch; 0 stands for the message's own time, its first field. Throws
  /// std::runtime_error when the disk is full.
  void write(const std::string& channel, const void* data, int size, std::int64_t log_utime = 0);
  /// Passes the written data to the kernel. Throws std::runtime_error when the disk is full.
  void flush();
  [[nodiscard]] std::int64_t bytes() const { return bytes_; }

 private:
  std::string file_;
  lcm_eventlog_t* log_ = nullptr;
  std::int64_t count_ = 0;
  std::int64_t bytes_ = 0;
};

}  // namespace curbstone
