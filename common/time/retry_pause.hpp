#pragma once

#include <algorithm>
#include <cstdint>

namespace curbstone {

/// When a device that is not there is tried again: after 0.1 s, and twice as long after each failure, up to 0.5 s: a
/// failed open() costs nothing, and a vehicle that starts waits for its devices. Times in us of the steady clock, which
/// the caller reads.
class RetryPause {
 public:
  static constexpr std::int64_t kFirst = 100'000;
  static constexpr std::int64_t kLast = 500'000;

  /// It has gone, after it was there.
  void lost(std::int64_t now) {
    next_ = kFirst;
    failed(now);
  }
  void failed(std::int64_t now) {
    due_ = now + next_;
    next_ = std::min(2 * next_, kLast);
  }
  [[nodiscard]] bool due(std::int64_t now) const { return now >= due_; }

 private:
  std::int64_t due_ = 0;
  std::int64_t next_ = kFirst;
};

}  // namespace curbstone
