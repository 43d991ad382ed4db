#pragma once

#include <cstdint>

namespace curbstone::mapper::returns {

/// A fault that begins once it was seen in `begins` looks in a row, and is over after `ends` looks in a row without it.
/// Pure; one thread.
class Verdict {
 public:
  Verdict(int begins, int ends) : begins_(begins), ends_(ends) {}

  /// Takes the next look, at `utime`, us. True if the fault begins with it.
  bool add(bool seen, std::int64_t utime) {
    newest_ = utime;
    if (seen == holds_) {
      looks_ = 0;
      return false;
    }
    if (!holds_ && looks_ == 0) since_ = utime;
    if (++looks_ < (holds_ ? ends_ : begins_)) return false;
    looks_ = 0;
    holds_ = !holds_;
    return holds_;
  }
  [[nodiscard]] bool holds() const { return holds_; }
  /// s from the first look that showed the fault to the last look.
  [[nodiscard]] double seconds() const { return static_cast<double>(newest_ - since_) * 1e-6; }

 private:
  int begins_, ends_;
  int looks_ = 0;  // in a row that contradict `holds_`
  bool holds_ = false;
  std::int64_t since_ = 0, newest_ = 0;  // us
};

}  // namespace curbstone::mapper::returns
