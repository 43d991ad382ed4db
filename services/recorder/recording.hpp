#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/log/log_writer.hpp"

namespace curbstone {

/// A recording in one file or several: FILE, or where that is taken FILE.1, FILE.2 and so on. Never overwrites. Each is
/// a log that lcm-logplayer reads.
class Recording {
 public:
  /// Opens the first file. Throws std::runtime_error with one clear line. `split` bytes, 0: never.
  Recording(std::string file, std::int64_t split);

  /// Throws std::runtime_error when the disk is full: the file then ends in a torn message, and the recording is at its
  /// end. A file in which nothing is whole is removed.
  void write(const std::string& channel, const void* data, int size, std::int64_t utime);
  /// What was written is the kernel's now: it survives the process. Throws likewise.
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

}  // namespace curbstone
