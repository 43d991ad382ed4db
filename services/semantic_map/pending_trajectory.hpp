#pragma once

#include <cstdint>
#include <curbstone/map_pose_t.hpp>
#include <curbstone/map_trajectory_t.hpp>
#include <deque>
#include <utility>
#include <variant>

namespace curbstone::semantic_map {

/// Holds the mapper's messages about the drive in an epoch that may begin (EpochFollower), until the epoch begins or is
/// rejected. At most kMaxMessages messages, the newest ones.
class PendingTrajectory {
 public:
  using Message = std::variant<map_pose_t, map_trajectory_t>;
  static constexpr std::size_t kMaxMessages = 64;  ///< of up to 42 kB; a new epoch is accepted with the second message

  /// Holds a message. Only messages of one epoch are held: those of another are dropped. Returns how many were dropped.
  template <typename Any>
  std::size_t hold(const Any& message) {
    std::size_t dropped = message.epoch == epoch_ ? 0 : clear();
    epoch_ = message.epoch;
    if (messages_.size() == kMaxMessages) {
      messages_.pop_front();
      ++dropped;
    }
    messages_.emplace_back(message);
    return dropped;
  }
  /// Returns how many messages were dropped.
  std::size_t clear() { return std::exchange(messages_, {}).size(); }
  /// The messages of the epoch that begins, in order of arrival.
  [[nodiscard]] std::deque<Message> take(std::int32_t epoch) {
    std::deque<Message> messages = std::exchange(messages_, {});
    return epoch == epoch_ ? std::move(messages) : std::deque<Message>{};
  }

 private:
  std::deque<Message> messages_;
  std::int32_t epoch_ = 0;
};

}  // namespace curbstone::semantic_map
