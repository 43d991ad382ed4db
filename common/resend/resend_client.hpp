#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>

#include "common/bus/bus.hpp"

namespace curbstone {

/// A gap in a listener's messages, between two that it has.
struct MissingMessages {
  std::int64_t after = 0;   ///< us, stamp of the last message before the gap
  std::int64_t before = 0;  ///< us, stamp of the first message after the gap
};

/// The listener's side of MessageKeeper: requests missing messages, and again while no answer comes. Some senders never
/// answer: a log, an earlier version, or one behind a relay that carries no answers. Each loss would then cost the full
/// wait for an answer. Therefore, after kPatience losses in a row without any answer, is_deaf() tells the caller for a
/// minute not to wait. One thread.
class ResendClient {
 public:
  static constexpr int kPatience = 3;
  static constexpr std::int64_t kRetryAfter = 200'000;     ///< us without an answer
  static constexpr std::int64_t kBackOff = 60'000'000;     ///< us of message time
  static constexpr std::int64_t kMaxMissing = 10'000'000;  ///< us: no sender keeps more than this

  ResendClient(Publisher& bus, std::string requester, std::string channel)
      : bus_(bus), requester_(std::move(requester)), channel_(std::move(channel)) {}

  /// The waiting time to add for this tick, us, from the `now` of this tick and of the one before (0: none). A process
  /// that was stopped sees seconds between two ticks, and the answer may be among messages that it has not handled yet:
  /// a tick counts for at most kMaxPerTick. In a replay ticks are far apart in message time.
  [[nodiscard]] static std::int64_t waited(std::int64_t now, std::int64_t before) {
    return before == 0 ? kTick : std::clamp(now - before, kTick, kMaxPerTick);
  }
  static constexpr std::int64_t kTick = 20'000;         ///< us: the minimum, also if the clock stands still
  static constexpr std::int64_t kMaxPerTick = 500'000;  ///< us

  /// Call each tick with the present gap. `now`, us, is used for pacing only.
  void ask(std::int64_t now, const std::optional<MissingMessages>& missing);

  /// A missing message has arrived.
  void answered() { unanswered_ = 0; }
  /// The listener no longer waits for the gap. `utime`: message time, us.
  void gave_up(std::int64_t utime) {
    ++unanswered_;
    gave_up_at_ = utime;
  }
  [[nodiscard]] bool is_deaf(std::int64_t utime) const {
    return unanswered_ >= kPatience && utime >= gave_up_at_ && utime - gave_up_at_ < kBackOff;
  }

 private:
  Publisher& bus_;
  std::string requester_, channel_;
  MissingMessages asked_;        // the gap at the last call
  std::int64_t asked_at_ = 0;    // us
  int unanswered_ = 0;           // in a row
  std::int64_t gave_up_at_ = 0;  // us
};

}  // namespace curbstone
