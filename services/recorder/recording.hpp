#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/log/log_writer.hpp"

namespace curbstone::recorder {

/// A recording in one file or several: FILE, or if that exists FILE.1, FILE.2 and so on. It never overwrites a file.
/// Each file is a log that lcm-logplayer reads. One thread.
class Recording {
 public:
  /// Opens the first file. Throws std::runtime_error with one clear line. `split` bytes, 0: never.
  Recording(std::string file, std::int64_t split);

  /// `utime`: us since the Unix epoch, the time of the record. Throws std::runtime_error when the disk is full. The
  /// file then ends in a torn message, and the recording is over. A file that holds no whole message is removed.
  void write(const std::string& channel, const void* data, int size, std::int64_t utime);
  /// Hands what was written to the kernel, so that it survives the process. Throws as write() does.
  void flush();

 private:
  void open();
  void give_up();

  std::string file_;
  std::int64_t split_;
  std::string current_;
  std::int64_t flushed_ = 0;  // bytes
  std::optional<LogWriter> log_;
};

}  // namespace curbstone::recorder
