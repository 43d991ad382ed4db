#pragma once

#include <array>

namespace curbstone::ekf::wheel_faults {

/// How a wheel's speed has differed from the filter's, and what would explain it: least squares of the difference
/// against the filter's speed (the wheel shows a multiple of it), the yaw rate (the track width is not the configured
/// one, or it skids in turns), and time (the filter drifts). Pure; one thread.
class WheelEvidence {
 public:
  struct Sample {
    double difference = 0.0;  ///< m/s, of the wheel from the filter
    double expected = 0.0;    ///< m/s, of the wheel, by the filter
    double turn = 0.0;        ///< m/s, yaw rate times track width
    double since = 0.0;       ///< s, since they came apart
    double seconds = 0.0;     ///< that it lasted
  };
  void add(const Sample& s);
  WheelEvidence& operator+=(const WheelEvidence& more);
  /// What is old counts less: within kMemory it fades.
  void fade(double seconds);

  /// The speed that the wheel shows, as a multiple of the filter's.
  [[nodiscard]] double ratio() const { return ratio_beyond(0.0); }
  /// m/s, of the wheel from the filter.
  [[nodiscard]] double mean_difference() const { return of(kSeconds) > 0 ? of(kD) / of(kSeconds) : 0.0; }
  /// It shows a multiple, at least `least` from 1, and no turning explains it half as well.
  [[nodiscard]] bool shows_multiple(double least) const;
  /// A part of the same time shows the same multiple. By a little the filter's speed may have been pulled along before.
  [[nodiscard]] bool agrees(const WheelEvidence& part) const;
  /// m/s by which it had pulled the filter along, as far as its speeds tell.
  [[nodiscard]] double pulled() const;
  /// A filter that drifts explains it half as well at least.
  [[nodiscard]] bool may_be_drift() const;

  static constexpr double kMemory = 10.0;  ///< s

 private:
  // What each explanation leaves unexplained, and what all may.
  [[nodiscard]] double beyond_multiple() const;
  [[nodiscard]] double beyond_turning() const;
  [[nodiscard]] double beyond_drift() const;
  [[nodiscard]] double noise() const;
  [[nodiscard]] double offset() const;
  [[nodiscard]] double ratio_beyond(double offset) const;

  // Sums over time of products: of d difference, e expected, w turn, t since.
  enum Sum { kD, kE, kDd, kDe, kEe, kDw, kWw, kDt, kTt, kSeconds, kSums };
  [[nodiscard]] double of(Sum sum) const { return sums_[sum]; }
  std::array<double, kSums> sums_{};
};

}  // namespace curbstone::ekf::wheel_faults
