#pragma once

#include <cstdint>
#include <deque>
#include <utility>

namespace curbstone {

/// Holds the first samples after a clock began. Nobody knows how late the very first arrived: it may have waited for
/// the driver to start, and a bunch with it, all with one time of receipt. A punctual one shows it in hindsight, and
/// the clock's offset falls; samples that had gone out by then would lie in the way of those that follow. So for
/// kSettling nothing goes out, and what waits is put earlier as the offset falls. Then all go, in order.
///
/// Message: with utime, us. Times of receipt do not decrease. Pure; one thread.
template <class Message>
class SettlingStart {
 public:
  static constexpr std::int64_t kSettling = 100'000;  ///< us, of receipt
  static constexpr std::size_t kMost = 1000;          ///< that wait

  /// A clock begins with the next sample. What waits is of the one before: release() it first.
  void begin(std::int64_t received) {
    begun_ = received;
    settling_ = true;
  }
  /// Takes the next sample. The clock's offset is now known to be less by `earlier` us: see ClockOffset. Then hands
  /// over what may go: calls send(message) for each.
  template <class Send>
  void pass(Message message, std::int64_t received, std::int64_t earlier, Send&& send) {
    for (Message& waiting : waiting_) waiting.utime -= earlier;
    waiting_.push_back(std::move(message));
    settling_ = settling_ && received - begun_ < kSettling && waiting_.size() < kMost;
    if (!settling_) release(send);
  }
  /// Hands over whatever waits.
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
