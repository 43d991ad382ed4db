#pragma once

#include <algorithm>
#include <cstdint>

namespace curbstone {

/// Back-off for a device that is missing: the first retry after 0.1 s, then twice as long after each failure, up to 0.5
/// s. The maximum is short because a failed open() costs nothing and a starting vehicle waits for its devices. Times in
/// us of the steady clock, which the caller reads.
class RetryBackoff {
 public:
  static constexpr std::int64_t kFirst = 100'000;
  static constexpr std::int64_t kLast = 500'000;

  /// The device has gone after it was present.
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
