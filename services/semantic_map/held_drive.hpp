#pragma once

#include <cstdint>
#include <curbstone/map_pose_t.hpp>
#include <curbstone/map_trajectory_t.hpp>
#include <deque>
#include <utility>
#include <variant>

namespace curbstone::semantic_map {

/// What the mapper says of the drive in an epoch that may begin (EpochFollower). It is kept until the epoch has begun
/// or turned out to be none. At most kMost messages, the newest ones.
class HeldDrive {
 public:
  using Message = std::variant<map_pose_t, map_trajectory_t>;
  static constexpr std::size_t kMost = 64;  ///< of up to 42 kB; a new epoch is believed at the second

  /// Only messages of one epoch are held: those of another one go. Returns how many were given up.
  template <typename Any>
  std::size_t hold(const Any& message) {
    std::size_t dropped = message.epoch == epoch_ ? 0 : clear();
    epoch_ = message.epoch;
    if (messages_.size() == kMost) {
      messages_.pop_front();
      ++dropped;
    }
    messages_.emplace_back(message);
    return dropped;
  }
  /// Returns how many were given up.
  std::size_t clear() { return std::exchange(messages_, {}).size(); }
  /// What was held of the epoch that begins, in its order.
  [[nodiscard]] std::deque<Message> take(std::int32_t epoch) {
    std::deque<Message> messages = std::exchange(messages_, {});
    return epoch == epoch_ ? std::move(messages) : std::deque<Message>{};
  }

 private:
  std::deque<Message> messages_;
  std::int32_t epoch_ = 0;
};

}  // namespace curbstone::semantic_map
