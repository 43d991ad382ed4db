#pragma once

#include <cstdint>
#include <cstdio>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/time/clock.hpp"
#include "procman/output/line_splitter.hpp"

namespace curbstone::procman::output {

/// How much of the output is kept.
struct KeepLimits {
  std::size_t lines = 200;                    ///< per command, in memory
  std::size_t file_bytes = 10 * 1024 * 1024;  ///< size at which a log file is rotated
  int old_files = 2;                          ///< rotated files per command: NAME.log.1, NAME.log.2
};

/// Keeps the last lines of each command in memory. With a folder it also writes all output to a bounded, rotated log
/// file per command, with the UTC time at the beginning of each line, "2026-11-23T08:15:02.250Z ". If the disk is full
/// or gone only the files are affected: lines that could not be written are counted, and reported as a fault while it
/// lasts. A file that was deleted or renamed meanwhile is begun again.
class OutputKeeper {
 public:
  /// `folder` empty: memory only. Creates the folder; throws std::runtime_error with a one-line message if it cannot,
  /// unless the disk is full, failing or mounted read-only. `clock`: us since the Unix epoch.
  explicit OutputKeeper(std::string folder, KeepLimits limits = {}, std::function<std::int64_t()> clock = wall_clock);

  /// Adds bytes in pieces of any size. Calls `on_line` for each complete line.
  template <class OnLine>
  void add(const std::string& id, std::string_view bytes, OnLine on_line) {
    Kept& kept = of(id);
    kept.splitter.feed(bytes, [&](std::string_view line) { keep(kept, line, on_line); });
  }
  /// The command has ended: completes an unfinished line.
  template <class OnLine>
  void end(const std::string& id, OnLine on_line) {
    Kept& kept = of(id);
    kept.splitter.flush([&](std::string_view line) { keep(kept, line, on_line); });
    if (kept.file) std::fflush(kept.file.get());
  }
  /// Writes a line of the deputy about the command to the file only: "-- started ...".
  void note(const std::string& id, std::string_view line);

  [[nodiscard]] const std::deque<std::string>& last_lines(const std::string& id);
  /// At most `most` of them.
  [[nodiscard]] std::vector<std::string> last_lines(const std::string& id, std::size_t most);
  void forget(const std::string& id) { kept_.erase(id); }
  /// Number of lines that no file has.
  [[nodiscard]] std::int64_t write_failures() const { return write_failures_; }
  /// A file whose last write failed, and why.
  [[nodiscard]] std::optional<std::string> fault() const;

 private:
  struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  struct Kept {
    LineSplitter splitter;
    std::deque<std::string> lines;
    std::string path;
    std::unique_ptr<std::FILE, CloseFile> file;
    std::size_t file_size = 0;
    std::string failure;  // of the latest write, in words
  };

  template <class OnLine>
  void keep(Kept& kept, std::string_view line, OnLine& on_line) {
    kept.lines.emplace_back(line);
    if (kept.lines.size() > limits_.lines) kept.lines.pop_front();
    write(kept, line);
    on_line(line);
  }
  Kept& of(const std::string& id);
  void write(Kept& kept, std::string_view text);
  void open(Kept& kept) const;
  void rotate(Kept& kept) const;

  std::string folder_;
  KeepLimits limits_;
  std::function<std::int64_t()> clock_;
  std::map<std::string, Kept> kept_;
  std::int64_t write_failures_ = 0;
};

}  // namespace curbstone::procman::output
