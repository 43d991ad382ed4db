#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>

namespace curbstone {

/// Whether an event repeats: `count` times within `within` us. Pure; times in us on one clock.
class RecentTimes {
 public:
  RecentTimes(std::size_t count, std::int64_t within) : count_(count), within_(within) {}

  void add(std::int64_t time) {
    if (!times_.empty() && time < times_.back()) times_.clear();  // the clock was set back
    times_.push_back(time);
    if (times_.size() > count_) times_.pop_front();
  }
  [[nodiscard]] bool often(std::int64_t now) const { return times_.size() == count_ && now - times_.front() < within_; }

 private:
  std::size_t count_;
  std::int64_t within_;
  std::deque<std::int64_t> times_;  // the last ones, oldest first
};

}  // namespace curbstone
