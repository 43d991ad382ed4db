#pragma once

#include <cstdint>
#include <deque>
#include <utility>

namespace curbstone {

/// Holds back the first samples after a ClockOffset began. How late the first one arrived is not known: it may have
/// waited for the driver to start, and others with it, all with one time of receipt. A later, punctual sample shows it,
/// and the offset falls. Stamps that had gone out by then would be later than those that follow. So nothing goes out
/// for kSettling, and the samples that wait are moved earlier as the offset falls. Then all go out, in order.
///
/// Message: has utime, us. Times of receipt do not decrease. Pure; one thread.
template <class Message>
class SettlingStart {
 public:
  static constexpr std::int64_t kSettling = 100'000;  ///< us, of receipt
  static constexpr std::size_t kMost = 1000;          ///< samples that wait; with more, all go out

  /// A clock begins with the next sample. Samples of the clock before must be released first.
  void begin(std::int64_t received) {
    begun_ = received;
    settling_ = true;
  }
  /// Takes the next sample, which showed the clock's offset to be less by `earlier` us: see ClockOffset. Then calls
  /// send(message) for each sample that may go out.
  template <class Send>
  void pass(Message message, std::int64_t received, std::int64_t earlier, Send&& send) {
    for (Message& waiting : waiting_) waiting.utime -= earlier;
    waiting_.push_back(std::move(message));
    settling_ = settling_ && received - begun_ < kSettling && waiting_.size() < kMost;
    if (!settling_) release(send);
  }
  /// Sends all that waits.
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
