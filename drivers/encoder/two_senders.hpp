#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>

namespace curbstone::encoder {

/// Detects two nodes that send counts with one id: the counts alternate between two values, which no wheel does. If the
/// values are far apart, WheelCounter stays with the node that it knows and refuses the other's counts as jumps. Two
/// nodes that were switched on together count alike at first, and all counts are plausible: then the right node is
/// unknown.
///
/// A turn is a change in one direction after a change in the other: both by at least kMinCounts and kMinAngle and,
/// for the first kBegin turns, by no more than a wheel can turn in kNear s. kBegin turns in a row mean two nodes; kEnd
/// counts in a row without a turn end that. A single corrupt count makes two turns. Pure; one thread.
class TwoSenders {
 public:
  static constexpr double kMinCounts = 8;
  static constexpr double kMinAngle = 0.01;  ///< rad
  static constexpr double kNear = 0.03;      ///< s
  static constexpr int kBegin = 5;
  static constexpr int kEnd = 32;

  TwoSenders(double counts_per_revolution, double max_speed)
      : least_(std::max(kMinCounts, kMinAngle * counts_per_revolution / (2 * std::numbers::pi))),
        most_(kNear * max_speed * counts_per_revolution / (2 * std::numbers::pi)) {}

  /// Adds raw counts in the order of receipt. Returns whether there are two senders.
  bool add(const std::array<std::int32_t, 2>& counts) {
    bool reversed = false;
    for (std::size_t wheel = 0; wheel < 2 && last_; ++wheel) {
      const double change = static_cast<std::int32_t>(static_cast<std::uint32_t>(counts[wheel]) -
                                                      static_cast<std::uint32_t>((*last_)[wheel]));
      const double least = std::min(std::abs(change), std::abs(changes_[wheel]));
      const double most = std::max(std::abs(change), std::abs(changes_[wheel]));
      reversed |= change * changes_[wheel] < 0 && least >= least_ && (detected_ || most <= most_);
      changes_[wheel] = change;
    }
    last_ = counts;
    reversals_ = reversed ? reversals_ + 1 : 0;
    steady_ = reversed ? 0 : steady_ + 1;
    if (reversals_ >= kBegin) detected_ = true;
    if (steady_ >= kEnd) detected_ = false;
    return detected_;
  }
  [[nodiscard]] bool detected() const { return detected_; }

 private:
  double least_, most_;  // counts
  std::optional<std::array<std::int32_t, 2>> last_;
  std::array<double, 2> changes_{};  // counts, the latest changes
  int reversals_ = 0;                // in a row
  int steady_ = 0;                   // counts in a row without a turn
  bool detected_ = false;
};

}  // namespace curbstone::encoder
