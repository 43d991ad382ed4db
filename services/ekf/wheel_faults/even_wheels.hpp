#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>

#include "services/ekf/inputs/wheel_odometer.hpp"

namespace curbstone::ekf::wheel_faults {

/// Detects counts that are made up: both wheels turn evenly, to fractions of a millimetre, while the IMU's speed
/// changes and then stays even too. A gateway that repeats an old speed does this, and a drive that counts its set
/// point instead of the measured motion. A change within the IMU's noise does not count. On no road do both wheels of a
/// real vehicle roll so evenly. The wheels of a simulator may, but then its IMU shows no change, and an IMU that was
/// knocked askew continues to show one.
///
/// Requires counters of 2048 steps or more; stamp jitter and coarser counts hide the effect. Pure; one thread.
class EvenWheels {
 public:
  static constexpr double kMinDuration = 1.5;    ///< s, minimum duration of even turning
  static constexpr double kMaxDuration = 15.0;   ///< s, the newest of which are compared
  static constexpr double kMaxDeviation = 8e-4;  ///< m, of the travel from a straight line: three counter steps
  static constexpr double kMinSpeed = 0.3;       ///< m/s, minimum speed of both wheels
  static constexpr double kMinChange = 0.5;      ///< m/s, minimum change of the IMU's speed
  static constexpr double kDrift = 0.04;         ///< m/s^2, drift of the IMU's speed that is allowed in addition
  static constexpr double kSettled = 0.15;  ///< m/s^2, maximum difference between its first and its last acceleration

  /// Adds the next interval. If it does not begin at the last one's end, everything restarts. `inertial_speed`: m/s,
  /// integrated from the IMU alone from an arbitrary zero, mean over the interval; `noise`: m/s^2/sqrt(Hz), its noise
  /// beyond the usual.
  void add(const inputs::WheelInterval& interval, double inertial_speed, double noise);
  /// Whether both wheels turn evenly.
  [[nodiscard]] bool even() const { return even_; }
  /// Whether, in addition, the IMU has measured a change of speed that was not a single leap and has ended: the counts
  /// are made up.
  [[nodiscard]] bool made_up() const { return made_up_; }
  /// m/s, the change of the IMU's speed.
  [[nodiscard]] double change() const { return change_; }

 private:
  struct Point {
    double seconds = 0.0;                 // since the first
    std::array<double, 2> distance = {};  // m, at the end of an interval
    double inertial_speed = 0.0;          // m/s, mean over the interval
    double variance = 0.0;                // m^2/s^2, of the speed since the first point, due to noise
  };
  [[nodiscard]] double duration() const { return points_.back().seconds - points_.front().seconds; }
  [[nodiscard]] bool rolls_evenly() const;
  [[nodiscard]] double acceleration(std::size_t from, std::size_t to) const;
  [[nodiscard]] bool imu_speed_changed(std::size_t from) const;

  std::deque<Point> points_;
  std::int64_t end_ = 0;  // us, of the last interval
  bool even_ = false;
  bool made_up_ = false;
  double change_ = 0.0;
};

}  // namespace curbstone::ekf::wheel_faults
