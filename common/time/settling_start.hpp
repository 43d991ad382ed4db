#pragma once

#include <cstdint>
#include <deque>
#include <utility>

namespace curbstone {

/// Holds back the first samples after a ClockOffset began. The delay of the first sample is unknown: it may have waited
/// for the driver to start, together with others, all with one receipt time. A later, punctual sample shows this, and
/// the offset falls. Samples published before that would have later stamps than those that follow. Therefore nothing is
/// published for kSettling, and the waiting samples are moved earlier as the offset falls. Then all are published, in
/// order.
///
/// Message: has utime, us. Receipt times do not decrease. Pure; one thread.
template <class Message>
class SettlingStart {
 public:
  static constexpr std::int64_t kSettling = 100'000;  ///< us of receipt time
  static constexpr std::size_t kMaxWaiting = 1000;    ///< waiting samples; with more, all are published

  /// A clock begins with the next sample. Samples of the previous clock must be released first.
  void begin(std::int64_t received) {
    begun_ = received;
    settling_ = true;
  }
  /// A sample lowered the clock's offset by `us`, whether it is published or refused: see ClockOffset.
  void move_earlier(std::int64_t us) {
    for (Message& waiting : waiting_) waiting.utime -= us;
  }
  /// Takes the next sample. Then calls send(message) for each sample that may be published.
  template <class Send>
  void pass(Message message, std::int64_t received, Send&& send) {
    waiting_.push_back(std::move(message));
    settling_ = settling_ && received - begun_ < kSettling && waiting_.size() < kMaxWaiting;
    if (!settling_) release(send);
  }
  /// Sends all waiting samples.
  template <class Send>
  void release(Send&& send) {
    for (; !waiting_.empty(); waiting_.pop_front()) send(waiting_.front());
  }

 private:
  std::int64_t begun_ = 0;  // us
  bool settling_ = false;
  std::deque<Message> waiting_;
};

}  // namespace curbstone
