#pragma once

#include <cstdint>

#include "common/log/message_order.hpp"
#include "tools/replay/stage_queue.hpp"

namespace curbstone::replay {

/// When the messages of a replay were published, for its record. A measurement has its own time. A tile's is that of
/// its newest points, which may be a minute old: it gets the time of the message before it. Between two steps of the
/// replay's time, times never go back. One thread.
class RecordClock {
 public:
  /// us since the Unix epoch. `message`: as StageLine::Options::everything gets it, in that order.
  [[nodiscard]] std::int64_t time_of(const LineItem& message) {
    const std::int64_t own = message_time(message.bytes.data(), message.bytes.size());
    if (last_ == 0) beat_ = last_ = own;
    if (message.now != 0 && message.now != beat_) beat_ = last_ = message.now;
    if (own > last_ && own < beat_ + kAhead) last_ = own;
    return last_;
  }

 private:
  static constexpr std::int64_t kAhead = 1'000'000;  // us: a stamp farther ahead is damaged
  std::int64_t beat_ = 0;                            // us
  std::int64_t last_ = 0;                            // us
};

}  // namespace curbstone::replay
