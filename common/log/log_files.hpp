#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/log/log_reader.hpp"

namespace curbstone {

/// Several logs of one drive, read as one: the files of a session folder or the files that the user names, in the order
/// of their first records. A split drive gives the events of the whole one in the same order. Files that overlap by
/// more than 0.2 s are merged by the times of their records. One thread.
class LogFiles {
 public:
  /// Each path is a log or a folder of logs. Throws std::runtime_error with one clear line.
  explicit LogFiles(const std::vector<std::string>& paths);

  [[nodiscard]] std::optional<LogEvent> next();

  /// The files, in the order in which they are read.
  [[nodiscard]] std::vector<std::string> names() const;
  [[nodiscard]] LogLoss loss() const;
  /// Notes for the user on what was read so far, one line each: gaps between files, overlaps, damage.
  [[nodiscard]] std::vector<std::string> notes() const;
  /// The fraction of all bytes read so far, 0..1.
  [[nodiscard]] double progress() const;

 private:
  struct File {
    std::string name;
    std::unique_ptr<LogReader> reader;
    std::optional<LogEvent> head;
    std::int64_t begin = 0;  // us, time of the first record
    double share = 0;        // fraction of all bytes
  };
  void open(const std::string& name, bool named_by_user);
  void begin_next();
  [[nodiscard]] File* earliest();

  std::vector<File> files_;
  std::size_t begun_ = 0;  // files from which reading has begun
  std::optional<std::int64_t> last_utime_;
  std::vector<std::string> notes_;
};

/// The logs of a folder, ordered by name: files that begin with a record or have "lcmlog" in their names.
[[nodiscard]] std::vector<std::string> logs_in(const std::filesystem::path& folder);

}  // namespace curbstone
