#pragma once

#include <algorithm>
#include <cstdint>

namespace curbstone {

/// How long a sender has been silent, by the ticks of the listener's loop. A listener that was stopped sees one long
/// tick, and the messages may wait behind it: a tick counts for kMaxPerTick at most, so silence counts from the
/// wake-up. A sender that has not spoken yet is missing only some time after the listener's start. Pure; one thread;
/// times in us.
class SilenceTimer {
 public:
  static constexpr std::int64_t kMaxPerTick = 500'000;  ///< us
  static constexpr std::int64_t kStart = 2'000'000;     ///< us in which a sender that is started too may be silent
  /// us of its uptime after which a process has named what never came: only then does no fault mean that it is ready.
  static constexpr std::int64_t kNamed = kStart + 500'000;

  /// `now`: us of any clock, also one that jumps.
  void tick(std::int64_t now) {
    if (ticked_ != 0) silent_ += std::clamp<std::int64_t>(now - ticked_, 0, kMaxPerTick);
    ticked_ = now;
  }
  void heard() {
    was_heard_ = true;
    silent_ = 0;
  }
  [[nodiscard]] bool was_heard() const { return was_heard_; }
  /// us since a message was heard, else since the first tick.
  [[nodiscard]] std::int64_t silent() const { return silent_; }
  /// Nothing was ever heard, although there was time enough.
  [[nodiscard]] bool never_came() const { return !was_heard_ && silent_ > kStart; }

 private:
  bool was_heard_ = false;
  std::int64_t ticked_ = 0;  // us; 0: never
  std::int64_t silent_ = 0;  // us
};

}  // namespace curbstone
