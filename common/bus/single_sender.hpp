#pragma once

#include <cstdint>
#include <optional>

namespace curbstone {

/// Tells the messages of one sender from those of another one on the same channel: a second driver, or a log that is
/// played into the bus. Mixed, the samples of two sensors are those of none.
///
/// Senders number their messages. A message is the sender's own if its number follows the last one and its stamp is
/// later by about the time that so many messages take, or if it is older by number and by stamp (late or sent twice).
/// The next number is its own whatever the stamp, for a clock may be set. Any other message is refused, except after
/// the sender has gone: the message is kRestart or three periods later than the last one, as no driver starts faster,
/// and at most kAbsence; or `gone` messages in a row were not its own. Then its successor is accepted. Messages without
/// numbers, all of which have the same, are accepted: nothing can be told of them.
///
/// The sender heard first is used. A function of the sequence of messages; pure; one thread; times in us.
class SingleSender {
 public:
  static constexpr std::int64_t kRestart = 50'000;
  static constexpr std::int64_t kAbsence = 10'000'000;
  static constexpr int kGone = 20;

  /// `gone`: more than a busy host delivers of the other sender's messages in one burst.
  explicit SingleSender(int gone = kGone) : gone_(gone) {}

  /// Returns whether the message is to be used.
  [[nodiscard]] bool accept(std::int64_t utime, std::int32_t number);
  /// Another sender's messages alternate with those of the one in use, kMinMessages or more in the last second.
  [[nodiscard]] bool two_send() const { return others_ >= kMinMessages; }

 private:
  struct Last {
    std::int64_t utime;
    std::int32_t number;
  };
  static constexpr int kMinMessages = 3;  // messages: one stray message is no second sender

  [[nodiscard]] bool is_own(std::int64_t utime, std::int32_t number) const;
  [[nodiscard]] bool has_gone(std::int64_t utime) const;
  void take(std::int64_t utime, std::int32_t number);

  int gone_;
  std::optional<Last> last_;  // of the sender in use
  bool numbered_ = false;     // its numbers count up
  double period_ = 0;         // us; 0: not known yet
  int refused_ = 0;           // since the sender's own latest message
  int others_ = 0;            // of another sender, between two of its own, in the last second
  std::int64_t other_ = 0;    // us, stamp of its own message after the latest of those
};

}  // namespace curbstone
