#pragma once

#include <cstdint>
#include <cstdlib>
#include <deque>

namespace curbstone::lidar {

/// Counts lost packets. A packet that arrives late is subtracted again, so a loss counts only when it is kSettled old.
/// Times in us, of receipt, on a clock that may be set: losses of a time that is still to come are settled too. Pure.
class LostPackets {
 public:
  static constexpr std::int64_t kSettled = 150'000;

  void add(std::int64_t now, std::int64_t packets) {
    if (packets > 0) recent_.push_back({now, packets});
    settle(now);
  }
  /// One of the latest missing packets arrived late.
  void subtract_late() {
    if (!recent_.empty() && --recent_.back().packets == 0) recent_.pop_back();
  }
  void settle(std::int64_t now) {
    for (; !recent_.empty() && (std::abs(now - recent_.front().at) >= kSettled || recent_.size() > kMaxRecent);
         recent_.pop_front())
      total_ += recent_.front().packets;
  }
  void settle_all() {
    for (; !recent_.empty(); recent_.pop_front()) total_ += recent_.front().packets;
  }
  [[nodiscard]] std::int64_t total() const { return total_; }

 private:
  static constexpr std::size_t kMaxRecent = 1000;
  struct Loss {
    std::int64_t at;
    std::int64_t packets;
  };
  std::deque<Loss> recent_;
  std::int64_t total_ = 0;
};

}  // namespace curbstone::lidar
