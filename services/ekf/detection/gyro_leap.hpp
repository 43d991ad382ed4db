#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "services/ekf/model/error_state.hpp"

namespace curbstone::ekf::detection {

/// Detects a leap of the gyro's bias about the vertical: the gyro's rate changes from one wheel interval to the next
/// but one and keeps its new value, while the wheels turn as before. When the vehicle begins to turn, the wheels show
/// the turn too; when a wheel slips, the gyro's rate does not change. Takes consecutive intervals and reports a leap
/// half a second late. A value type; one thread.
class GyroLeap {
 public:
  static constexpr double kMinLeap = 0.0087;  ///< rad/s: 0.5 deg/s

  struct Leap {
    double rate = 0.0;       ///< rad/s that the gyro has shown in excess since the leap
    double sigma = 0.0;      ///< rad/s, 1 sigma of `rate`
    double seconds = 0.0;    ///< s since the leap
    model::NavState before;  ///< the state before the leap: what the filter has learnt since is wrong
  };
  /// Adds an interval's mean yaw rates, rad/s, of wheels and gyro, both without any correction that the filter learns
  /// meanwhile.
  std::optional<Leap> add(double seconds, double by_wheels, double by_gyro, const model::NavState& state) {
    std::rotate(intervals_.begin(), intervals_.begin() + 1, intervals_.end());
    intervals_.back() = {seconds, by_wheels, by_gyro, state};
    known_ = std::min(known_ + 1, kIntervals);
    if (known_ < kIntervals) return {};
    const Rates before = rates(0), after = rates(kSide + 1);
    Leap leap{after.difference - before.difference, std::sqrt((before.variance + after.variance) / kSide),
              after.seconds, intervals_[kSide - 1].state};
    const double size = std::abs(leap.rate);
    const Interval& last = intervals_[kSide - 1];
    const Interval& first = intervals_[kSide + 1];
    const bool steady = std::max(before.variance, after.variance) < std::pow(kSteady * size, 2);
    const bool by_the_gyro = std::abs(first.by_gyro - last.by_gyro - leap.rate) < kSudden * size;
    const bool wheels_too = std::abs(first.by_wheels - last.by_wheels) > kQuiet * size;
    if (size < kMinLeap || !steady || !by_the_gyro || wheels_too) return {};
    leap.seconds += 0.5 * intervals_[kSide].seconds;
    interrupt();
    return leap;
  }
  /// Call it where intervals are missing.
  void interrupt() { known_ = 0; }

 private:
  static constexpr std::size_t kSide = 10;  // intervals on each side of the leap
  static constexpr std::size_t kIntervals = 2 * kSide + 1;
  static constexpr double kSteady = 0.25;  // 1 sigma of an interval, as a share of the leap
  // As shares of the leap: by how much the gyro's step may differ from the leap, and by how much the wheels' rate may
  // change. With these bounds a gyro that shows up to 2.8 times the turn is not reported at the beginning of a bend.
  static constexpr double kSudden = 0.3, kQuiet = 0.25;
  struct Interval {
    double seconds, by_wheels, by_gyro;
    model::NavState state;
  };
  struct Rates {
    double difference = 0.0;  // rad/s, mean of the gyro's rate minus the wheels'
    double variance = 0.0;    // of a single interval
    double seconds = 0.0;
  };
  [[nodiscard]] Rates rates(std::size_t begin) const {
    Rates rates;
    for (std::size_t i = begin; i < begin + kSide; ++i) {
      rates.difference += (intervals_[i].by_gyro - intervals_[i].by_wheels) / kSide;
      rates.seconds += intervals_[i].seconds;
    }
    for (std::size_t i = begin; i < begin + kSide; ++i)
      rates.variance += std::pow(intervals_[i].by_gyro - intervals_[i].by_wheels - rates.difference, 2) / (kSide - 1);
    return rates;
  }

  std::array<Interval, kIntervals> intervals_{};  // newest last
  std::size_t known_ = 0;
};

}  // namespace curbstone::ekf::detection
