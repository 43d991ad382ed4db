#pragma once

#include <array>

namespace curbstone::ekf::wheel_faults {

/// Explains how a wheel's speed differs from the filter's: least squares of the difference against the filter's speed
/// (the wheel shows a multiple of it), the yaw rate (the track width is wrong, or the wheel skids in turns), and time
/// (the filter drifts). Pure; one thread.
class WheelEvidence {
 public:
  struct Sample {
    double difference = 0.0;  ///< m/s, wheel minus filter
    double expected = 0.0;    ///< m/s, the filter's expectation of the wheel
    double turn = 0.0;        ///< m/s, yaw rate times track width
    double since = 0.0;       ///< s since they came apart
    double seconds = 0.0;     ///< duration
  };
  void add(const Sample& s);
  WheelEvidence& operator+=(const WheelEvidence& more);
  /// Reduces the weight of old samples, with kMemory.
  void fade(double seconds);

  /// The wheel's speed as a multiple of the filter's.
  [[nodiscard]] double ratio() const { return ratio_without_offset(0.0); }
  /// m/s, wheel minus filter.
  [[nodiscard]] double mean_difference() const { return sum(kDuration) > 0 ? sum(kDiff) / sum(kDuration) : 0.0; }
  /// Whether it shows a multiple that differs from 1 by at least `least`, and turning does not explain it half as well.
  [[nodiscard]] bool has_scale_error(double least) const;
  /// Whether a part of the same time shows the same multiple. The filter's speed may have been pulled along a little
  /// before.
  [[nodiscard]] bool agrees(const WheelEvidence& part) const;
  /// m/s by which the wheel had pulled the filter along, as far as its speeds show.
  [[nodiscard]] double filter_offset() const;
  /// Whether a drift of the filter explains the difference at least half as well.
  [[nodiscard]] bool may_be_drift() const;

  static constexpr double kMemory = 10.0;  ///< s

 private:
  // Residuals of each explanation, and the noise that is allowed for all of them.
  [[nodiscard]] double scale_residual() const;
  [[nodiscard]] double turning_residual() const;
  [[nodiscard]] double drift_residual() const;
  [[nodiscard]] double noise() const;
  [[nodiscard]] double offset() const;
  [[nodiscard]] double ratio_without_offset(double offset) const;

  // Sums over time of products: d is the difference, e expected, w turn, t since.
  enum Sum {
    kDiff,
    kExpected,
    kDiffDiff,
    kDiffExpected,
    kExpectedExpected,
    kDiffTurn,
    kTurnTurn,
    kDiffTime,
    kTimeTime,
    kDuration,
    kSums
  };
  [[nodiscard]] double sum(Sum product) const { return sums_[product]; }
  std::array<double, kSums> sums_{};
};

}  // namespace curbstone::ekf::wheel_faults
