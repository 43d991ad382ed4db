#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "services/ekf/wheel_faults/recent_speeds.hpp"
#include "services/ekf/wheel_faults/wheel_evidence.hpp"
#include "services/ekf/wheel_faults/wheel_observation.hpp"

namespace curbstone::ekf::wheel_faults {

/// Decides, while all trusted wheels are refused without a break, whether the wheels are wrong or the filter is, from
/// the way in which the two came apart.
///
/// The wheels are wrong if each of them shows the same multiple of the filter's speed in every part of the time, one
/// that no wrong radius explains, and the IMU did not leap: neither far, nor by most of the later difference (which at
/// an even speed looks like a multiple). Otherwise the filter is wrong. Where a drift of the filter explains the
/// difference as well (the vehicle speeds up evenly), the decision waits for more data. Pure; one thread.
class WheelDispute {
 public:
  struct Settings {
    double patience;     ///< s after which finding() is called
    double track_width;  ///< m
  };
  /// `begin`: us, since when the wheels are refused; `leap`: the speeds' change up to the end of the first interval.
  WheelDispute(const Settings& settings, std::int64_t begin, const RecentSpeeds::Leap& leap)
      : settings_(settings), leap_(leap), begin_(begin), end_(begin) {}

  /// Adds the next interval in which all `trusted` wheels (at least one) are refused.
  void add(const WheelObservation& observation, const std::array<bool, 2>& trusted);

  /// Takes the speeds' change up to the newest interval's end: a leap may take several intervals.
  void update_leap(const RecentSpeeds::Leap& leap);

  /// Which one is wrong; kUndecided: either explains the difference.
  enum class Finding { kUndecided, kWheelsWrong, kFilterWrong };
  [[nodiscard]] Finding finding() const;
  /// Waits for another patience after kUndecided.
  void extend();

  /// All evidence of a wheel.
  [[nodiscard]] WheelEvidence evidence(std::size_t wheel) const;

  /// How far the wheels may have pulled the filter off before they were refused, after `distance` m driven with them.
  /// Wheels that went wrong at once have not.
  struct FilterError {
    double speed = 0.0;     ///< m/s
    double position = 0.0;  ///< m
    double seconds = 0.0;   ///< since they were refused
  };
  [[nodiscard]] FilterError filter_error(double distance) const;

  /// m/s, the filter's latest expectation of the wheels' speed.
  [[nodiscard]] double expected_speed() const { return expected_speed_; }

  static constexpr double kFrozen = 0.02;  ///< share of the speed: a wheel that shows less stands still
  static constexpr double kBefore = 0.5;   ///< s that a drifting filter takes until it is refused

 private:
  static constexpr std::size_t kSegments = 4;
  using Segments = std::array<WheelEvidence, kSegments>;
  [[nodiscard]] std::size_t segment_at(double since) const;
  [[nodiscard]] bool imu_leapt() const;

  Settings settings_;
  RecentSpeeds::Leap leap_;
  std::int64_t begin_, end_;       // us
  std::array<bool, 2> trusted_{};  // the wheels
  // By wheel: the patience in equal parts. After an extension [0] is all before it, and the others are the newest one.
  std::array<Segments, 2> segments_{};
  int extensions_ = 0;                      // number of patiences without a decision
  std::optional<double> first_difference_;  // m/s, wheels minus filter, at the beginning
  double expected_speed_ = 0.0;             // m/s
};

}  // namespace curbstone::ekf::wheel_faults
