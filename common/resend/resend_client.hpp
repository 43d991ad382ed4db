#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>

#include "common/bus/bus.hpp"

namespace curbstone {

/// Messages that a listener lacks: those between two that it has.
struct MissingMessages {
  std::int64_t after = 0;   ///< us, stamp of the last before
  std::int64_t before = 0;  ///< us, stamp of the first behind
};

/// The listener's side of MessageKeeper: asks for what is missing, and again while nothing comes. Some senders never
/// answer: a log's, one of an earlier version, one behind a relay that carries no answers. Each loss would then cost
/// the time that the answer is waited for. So after kPatience losses in a row of which nothing came again, is_deaf()
/// says for a minute not to wait. One thread.
class ResendClient {
 public:
  static constexpr int kPatience = 3;
  static constexpr std::int64_t kAskAgain = 200'000;        ///< us without an answer
  static constexpr std::int64_t kDeafFor = 60'000'000;      ///< us of message time
  static constexpr std::int64_t kMostMissing = 10'000'000;  ///< us: more is kept by nobody

  ResendClient(Publisher& bus, std::string requester, std::string channel)
      : bus_(bus), requester_(std::move(requester)), channel_(std::move(channel)) {}

  /// How much longer something has been waited for, us, by the `now` of this tick and of the one before (0: none). Who
  /// has been stopped hears seconds between two ticks, and the answer may be among what it has not heard yet: a tick
  /// counts for kMostATick at most. In a replay ticks are far apart in message time.
  [[nodiscard]] static std::int64_t waited(std::int64_t now, std::int64_t before) {
    return before == 0 ? kTick : std::clamp(now - before, kTick, kMostATick);
  }
  static constexpr std::int64_t kTick = 20'000;        ///< us: where the clock stands still, too
  static constexpr std::int64_t kMostATick = 500'000;  ///< us

  /// Each tick, with what is missing now. `now`, us, only paces.
  void ask(std::int64_t now, const std::optional<MissingMessages>& missing);

  /// Something that was missing has come.
  void answered() { unanswered_ = 0; }
  /// It is no longer waited for. `utime`: message time, us.
  void gave_up(std::int64_t utime) {
    ++unanswered_;
    gave_up_at_ = utime;
  }
  [[nodiscard]] bool is_deaf(std::int64_t utime) const {
    return unanswered_ >= kPatience && utime >= gave_up_at_ && utime - gave_up_at_ < kDeafFor;
  }

 private:
  Publisher& bus_;
  std::string requester_, channel_;
  MissingMessages asked_;        // for what, when looked at last
  std::int64_t asked_at_ = 0;    // us
  int unanswered_ = 0;           // in a row
  std::int64_t gave_up_at_ = 0;  // us
};

}  // namespace curbstone
