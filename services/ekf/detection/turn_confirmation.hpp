#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace curbstone::ekf::detection {

/// Decides whether wheels and gyro, two independent sensors, have shown the same turn over the last second. A wrong
/// scale or bias of the gyro, a wrong track width or radius, and a slipping wheel make them differ. Takes consecutive
/// intervals of the wheels. A value type; one thread.
class TurnConfirmation {
 public:
  static constexpr double kMaxDifference = 0.009;  ///< rad in that second: 0.5 deg

  /// Adds an interval's mean yaw rates, rad/s: of the wheels, and of the gyro minus its bias.
  void add(double seconds, double by_wheels, double by_gyro) {
    open_.seconds += seconds;
    open_.difference += seconds * (by_wheels - by_gyro);
    if (open_.seconds < kSpan / kBins) return;
    std::rotate(bins_.begin(), bins_.begin() + 1, bins_.end());
    bins_.back() = open_;
    open_ = {};
    known_ = std::min(known_ + 1, kBins);
  }
  /// Call it where intervals are missing.
  void interrupt() {
    open_ = {};
    known_ = 0;
  }
  [[nodiscard]] bool confirmed() const {
    double difference = open_.difference;
    for (const Bin& bin : bins_) difference += bin.difference;
    return known_ == kBins && std::abs(difference) < kMaxDifference;
  }

 private:
  static constexpr double kSpan = 1.0;  // s, minimum span
  static constexpr int kBins = 10;
  struct Bin {
    double seconds = 0.0;
    double difference = 0.0;  // rad, turn of the wheels minus that of the gyro
  };
  std::array<Bin, kBins> bins_{};  // newest last
  int known_ = 0;
  Bin open_;
};

}  // namespace curbstone::ekf::detection
