#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <optional>

#include "common/geometry/geometry.hpp"

namespace curbstone::ekf::filter {

/// The latest poses, bounded in number, with interpolation at any time between them.
class PoseHistory {
 public:
  explicit PoseHistory(std::size_t capacity) : capacity_(capacity) {}

  /// Times must increase; an entry whose time does not is ignored.
  void add(std::int64_t utime, const Pose& T_odom_base) {
    if (!entries_.empty() && utime <= entries_.back().utime) return;
    entries_.push_back({utime, T_odom_base});
    if (entries_.size() > capacity_) entries_.pop_front();
  }
  void clear() { entries_.clear(); }

  /// Interpolated pose; nothing before the oldest or after the newest entry.
  [[nodiscard]] std::optional<Pose> at(std::int64_t utime) const {
    const auto after = std::lower_bound(entries_.begin(), entries_.end(), utime,
                                        [](const Entry& entry, std::int64_t t) { return entry.utime < t; });
    if (after == entries_.end()) return std::nullopt;
    if (after->utime == utime) return after->pose;
    if (after == entries_.begin()) return std::nullopt;
    const auto before = std::prev(after);
    const double fraction =
        static_cast<double>(utime - before->utime) / static_cast<double>(after->utime - before->utime);
    return interpolate(before->pose, after->pose, fraction);
  }

 private:
  struct Entry {
    std::int64_t utime;
    Pose pose;
  };
  std::size_t capacity_;
  std::deque<Entry> entries_;
};

}  // namespace curbstone::ekf::filter
