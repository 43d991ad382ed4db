#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"
#include "common/geometry/geometry.hpp"

namespace curbstone::mapper::mounting {

/// Checks that the map's vertical agrees with odometry's, which knows gravity. If registration slides in pitch or roll
/// because too few lasers return, or if the mount gives way slowly, every revolution fits the map, but the map descends
/// into the ground or climbs out of it.
///
/// Pure; one thread. Counter: faults.apart.lean (times that the fault began).
class MapLean {
 public:
  static constexpr double kMaxLean = 0.087;  ///< rad: 5 deg. Odometry is right to 1 deg, also under braking
  static constexpr std::int64_t kMinDuration = 3'000'000;  ///< us, without a break

  /// Adds the next revolution, which fitted the map.
  void add(std::int64_t utime, const Pose& T_map_base, const Pose& T_odom_base) {
    const double alike = T_map_base.linear().row(2).dot(T_odom_base.linear().row(2));  // of z, in base_link
    lean_ = std::acos(std::clamp(alike, -1.0, 1.0));
    if (lean_ < kMaxLean || utime < since_) {
      since_ = 0;
      leans_ = false;
    } else if (since_ == 0) {
      since_ = utime;
    } else if (!leans_ && utime - since_ >= kMinDuration) {
      leans_ = true;
      counters_.add("faults.apart.lean");
    }
  }
  /// Breaks the sequence: the next revolution is not compared with earlier ones.
  void interrupt() {
    since_ = 0;
    leans_ = false;
  }
  void add_faults(std::vector<std::string>& faults) const {
    if (!leans_) return;
    faults.push_back(fmt::format(
        "LiDAR: the map leans by {:.0f} deg against gravity by odometry: do most of its lasers return, does "
        "its mount give way? Else the IMU's accelerometer is wrong (an axis, its bias), and the map is not",
        lean_ * 180 / std::numbers::pi));
  }
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  double lean_ = 0.0;       // rad
  std::int64_t since_ = 0;  // us: start of the lean beyond kMaxLean; 0: none
  bool leans_ = false;
  Counters counters_;
};

}  // namespace curbstone::mapper::mounting
