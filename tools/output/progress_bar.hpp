#pragma once

#include <cstdint>
#include <string>

namespace curbstone::output {

/// The progress of a command and the remaining time, on one line of stderr, redrawn at most ten times per second.
/// Nothing is written if stderr is not a terminal.
class ProgressBar {
 public:
  explicit ProgressBar(std::string name);
  /// Removes the line.
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Whether show() would draw now, so that a caller can skip preparing the remark.
  [[nodiscard]] bool is_due() const;
  /// `fraction`: 0..1 of the work. `remark` follows the bar: "12.3 s of drive".
  void show(double fraction, const std::string& remark = {});
  /// Removes the line so that other text can be written.
  void clear();

 private:
  std::string name_;
  bool on_terminal_;
  std::int64_t begin_;  // us, steady
  std::int64_t shown_ = 0;
};

/// The line: "replay [####......]  40 %  0:12 left  12.3 s of drive". `elapsed` in seconds.
[[nodiscard]] std::string progress_line(const std::string& name, double fraction, double elapsed,
                                        const std::string& remark);

}  // namespace curbstone::output
