#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "services/ekf/model/error_state.hpp"

namespace curbstone::ekf::detection {

/// A gyro whose bias about the vertical leaps: from one interval of the wheels to the next but one it shows another
/// rate, and goes on showing it, while the wheels turn as before. A vehicle that begins to turn shows it by its wheels
/// too, and a wheel that slips leaves the gyro's rate as it is. Consecutive intervals go in; a leap comes out half a
/// second late. A value type; one thread.
class GyroLeap {
 public:
  static constexpr double kLeast = 0.0087;  ///< rad/s: 0.5 deg/s

  struct Leap {
    double rate = 0.0;       ///< rad/s, that the gyro shows too much since
    double sigma = 0.0;      ///< rad/s, of that
    double seconds = 0.0;    ///< ago
    model::NavState before;  ///< what the filter had learnt until then: since, it has learnt nonsense
  };
  /// An interval's mean yaw rates, rad/s, as the wheels and the gyro show it: nothing that the filter learns meanwhile
  /// is in them.
  std::optional<Leap> add(double seconds, double by_wheels, double by_gyro, const model::NavState& state) {
    std::rotate(intervals_.begin(), intervals_.begin() + 1, intervals_.end());
    intervals_.back() = {seconds, by_wheels, by_gyro, state};
    known_ = std::min(known_ + 1, kIntervals);
    if (known_ < kIntervals) return {};
    const Rates before = rates(0), after = rates(kSide + 1);
    Leap leap{after.apart - before.apart, std::sqrt((before.variance + after.variance) / kSide), after.seconds,
              intervals_[kSide - 1].state};
    const double size = std::abs(leap.rate);
    const Interval& last = intervals_[kSide - 1];
    const Interval& first = intervals_[kSide + 1];
    const bool steady = std::max(before.variance, after.variance) < std::pow(kSteady * size, 2);
    const bool by_the_gyro = std::abs(first.by_gyro - last.by_gyro - leap.rate) < kSudden * size;
    const bool wheels_too = std::abs(first.by_wheels - last.by_wheels) > kQuiet * size;
    if (size < kLeast || !steady || !by_the_gyro || wheels_too) return {};
    leap.seconds += 0.5 * intervals_[kSide].seconds;
    interrupt();
    return leap;
  }
  /// Intervals are missing.
  void interrupt() { known_ = 0; }

 private:
  static constexpr std::size_t kSide = 10;  // intervals before, and after
  static constexpr std::size_t kIntervals = 2 * kSide + 1;
  static constexpr double kSteady = 0.25;  // of the leap: 1 sigma of an interval
  // Of the leap: how much more or less the gyro may change from the one to the other side, and the wheels at all. A
  // gyro that shows up to 2.8 times the turn does not leap at the beginning of a bend by that.
  static constexpr double kSudden = 0.3, kQuiet = 0.25;
  struct Interval {
    double seconds, by_wheels, by_gyro;
    model::NavState state;
  };
  struct Rates {
    double apart = 0.0;     // rad/s, mean of what the gyro shows more than the wheels
    double variance = 0.0;  // of an interval
    double seconds = 0.0;
  };
  [[nodiscard]] Rates rates(std::size_t begin) const {
    Rates rates;
    for (std::size_t i = begin; i < begin + kSide; ++i) {
      rates.apart += (intervals_[i].by_gyro - intervals_[i].by_wheels) / kSide;
      rates.seconds += intervals_[i].seconds;
    }
    for (std::size_t i = begin; i < begin + kSide; ++i)
      rates.variance += std::pow(intervals_[i].by_gyro - intervals_[i].by_wheels - rates.apart, 2) / (kSide - 1);
    return rates;
  }

  std::array<Interval, kIntervals> intervals_{};  // newest last
  std::size_t known_ = 0;
};

}  // namespace curbstone::ekf::detection
