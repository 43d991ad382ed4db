#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "services/ekf/wheel_faults/recent_speeds.hpp"
#include "services/ekf/wheel_faults/wheel_evidence.hpp"
#include "services/ekf/wheel_faults/wheel_look.hpp"

namespace curbstone::ekf::wheel_faults {

/// All trusted wheels are refused without a break: either they are wrong, or the filter is. By how the two came apart
/// it finds whose fault it is.
///
/// It is the wheels' if each of them shows the same multiple of the filter's speed in every part of the time, one that
/// no wrong radius explains, and the IMU did not leap: neither far, nor by most of what they have differed by since,
/// which at an even speed looks like a multiple. Else it is the filter's. Where a filter that drifts explains the
/// wheels as well (it speeds up evenly), it waits for more. Pure; one thread.
class WheelDispute {
 public:
  struct Settings {
    double patience;     ///< s, after which finding() is asked for
    double track_width;  ///< m
  };
  /// `begin`: us, from when on they are refused; `leap`: what the speeds did by its first interval's end.
  WheelDispute(const Settings& settings, std::int64_t begin, const RecentSpeeds::Leap& leap)
      : settings_(settings), leap_(leap), begin_(begin), end_(begin) {}

  /// The next interval in which all wheels that are `trusted` (one at least) are refused.
  void add(const WheelLook& look, const std::array<bool, 2>& trusted);

  /// What the speeds did by the newest interval's end: a leap may take some of them.
  void note(const RecentSpeeds::Leap& leap);

  /// Whose fault it is; kNone: either explains it.
  enum class Finding { kNone, kWheels, kFilter };
  [[nodiscard]] Finding finding() const;
  /// Waits for another patience, after kNone.
  void await_more();

  /// What a wheel showed in all that time.
  [[nodiscard]] WheelEvidence evidence(std::size_t wheel) const;

  /// How far the wheels may have led the filter astray, which had driven `way` m by them: they pull it along before
  /// they are refused. Those that went wrong at a stroke have not.
  struct Astray {
    double speed = 0.0;    ///< m/s
    double place = 0.0;    ///< m
    double seconds = 0.0;  ///< since they were refused
  };
  [[nodiscard]] Astray astray(double way) const;

  /// m/s, the newest that the filter expected of the wheels.
  [[nodiscard]] double expected_speed() const { return expected_speed_; }

  static constexpr double kFrozen = 0.02;  ///< of the speed: a wheel that shows less stands still
  static constexpr double kBefore = 0.5;   ///< s that a drifting filter takes to be refused

 private:
  static constexpr std::size_t kParts = 4;
  using Parts = std::array<WheelEvidence, kParts>;
  [[nodiscard]] std::size_t part_at(double since) const;
  [[nodiscard]] bool imu_leapt() const;

  Settings settings_;
  RecentSpeeds::Leap leap_;
  std::int64_t begin_, end_;       // us
  std::array<bool, 2> trusted_{};  // the wheels
  std::array<Parts, 2> parts_{};   // of the patience, of each wheel; later, of what was before, and the newest one
  int patiences_ = 0;              // that have passed in vain
  std::optional<double> first_difference_;  // m/s, of the wheels from the filter, when it began
  double expected_speed_ = 0.0;             // m/s
};

}  // namespace curbstone::ekf::wheel_faults
