#pragma once

#include <cstdint>
#include <string>

namespace curbstone::output {

/// How far a command is and how long it will take, on one line of stderr that is drawn anew ten times a second at most.
/// Where stderr is not a terminal nothing is written.
class ProgressBar {
 public:
  explicit ProgressBar(std::string name);
  /// Takes the line away.
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Whether it is time to show something: for those who would work for it in vain.
  [[nodiscard]] bool is_due() const;
  /// `fraction` is 0..1 of the work. `remark` stands behind it: "12.3 s of drive".
  void show(double fraction, const std::string& remark = {});
  /// So that something else can be written.
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
