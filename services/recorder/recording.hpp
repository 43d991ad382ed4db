#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "common/log/log_writer.hpp"

namespace curbstone::recorder {

/// A recording in one or several files. It never overwrites a file. Each file is a log that lcm-logplayer reads. One
/// thread.
class Recording {
 public:
  using NextName = std::function<std::string()>;  ///< name of a file that does not exist
  using Head = std::function<void(LogWriter&, std::int64_t utime)>;

  /// `head` writes the beginning of each file, at the time of its first record. `split`: bytes, 0: never. Opens the
  /// first file. Throws std::runtime_error with one clear line.
  Recording(NextName next_name, std::int64_t split, Head head = {});

  /// Writes a record. `utime`: us since the Unix epoch, the time of the record. Throws std::runtime_error when the disk
  /// is full. The file then ends in a torn message, and the recording is over. A file without a whole message is
  /// removed.
  void write(const std::string& channel, const void* data, int size, std::int64_t utime);
  /// Passes the written data to the kernel, so that it survives the process. Throws as write() does, and
  /// FileDeleted.
  void flush();
  /// Records in the current file, in the kernel or not.
  [[nodiscard]] std::int64_t num_records() const { return num_records_; }

 private:
  void open();
  void give_up();
  [[nodiscard]] bool is_there() const;

  NextName next_name_;
  std::int64_t split_;
  Head head_;
  std::string current_;
  std::int64_t flushed_ = 0;  // bytes
  std::int64_t num_records_ = 0;
  std::optional<LogWriter> log_;
  std::pair<std::uint64_t, std::uint64_t> identity_;  // of the file: device and number
};

/// The file was deleted while it was written, with all that was in it.
class FileDeleted : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// FILE, or if it exists FILE.1, FILE.2 and so on.
[[nodiscard]] std::string unused_name(const std::string& file);

}  // namespace curbstone::recorder
