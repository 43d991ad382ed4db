#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>

#include "services/ekf/inputs/wheel_odometer.hpp"

namespace curbstone::ekf::wheel_faults {

/// Whether the wheels' counts are made up: both turn on evenly, to fractions of a millimetre, while the IMU speeds up
/// or slows down and then goes on evenly too. So does a gateway that repeats the speed of before, or a drive that
/// counts what it was told and not what it measures. What the IMU's noise adds up to is no other speed. No road lets
/// both wheels of a real vehicle roll so evenly; and where a simulator's do, its IMU feels nothing meanwhile, or an IMU
/// that was knocked askew goes on to feel it.
///
/// Counters of 2048 steps and more; stamps that jitter, or counts that are coarser, hide it. Pure; one thread.
class EvenWheels {
 public:
  static constexpr double kLeast = 1.5;     ///< s that they have turned so,
  static constexpr double kMost = 15.0;     ///< of which this much is remembered
  static constexpr double kWay = 8e-4;      ///< m, by which the way may be off an even one: three steps
  static constexpr double kSpeed = 0.3;     ///< m/s, that both wheels show at least
  static constexpr double kChange = 0.5;    ///< m/s, of the IMU's speed,
  static constexpr double kDrift = 0.04;    ///< m/s^2, and what an IMU may drift by
  static constexpr double kSettled = 0.15;  ///< m/s^2, by which it accelerates otherwise than before

  /// The next interval. Where it does not begin at the last one's end, all begins anew. `inertial_speed`: m/s, by the
  /// IMU alone since any start, mean over it; `noise`: m/s^2/sqrt(Hz), of that beyond what any IMU has.
  void add(const inputs::WheelInterval& interval, double inertial_speed, double noise);
  /// Both turn evenly.
  [[nodiscard]] bool even() const { return even_; }
  /// And the IMU has felt another speed, not by one leap, and does no longer: they are made up.
  [[nodiscard]] bool made_up() const { return made_up_; }
  /// m/s, by which that differs from the one of before.
  [[nodiscard]] double change() const { return change_; }

 private:
  struct Point {
    double seconds = 0.0;            // since the first
    std::array<double, 2> way = {};  // m, at the end of an interval
    double inertial_speed = 0.0;     // m/s, mean over it
    double variance = 0.0;           // m^2/s^2, since the first, by the noise
  };
  [[nodiscard]] double duration() const { return points_.back().seconds - points_.front().seconds; }
  [[nodiscard]] bool rolls_evenly() const;
  [[nodiscard]] double acceleration(std::size_t from, std::size_t to) const;
  [[nodiscard]] bool felt_another_speed(std::size_t from) const;

  std::deque<Point> points_;
  std::int64_t end_ = 0;  // us, of the last interval
  bool even_ = false;
  bool made_up_ = false;
  double change_ = 0.0;
};

}  // namespace curbstone::ekf::wheel_faults
