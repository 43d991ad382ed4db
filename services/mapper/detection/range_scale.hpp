#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"
#include "common/geometry/geometry.hpp"
#include "services/mapper/mounting/lidar_mounting.hpp"

namespace curbstone::mapper::detection {

/// Detects ranges that are all too long or too short by the same factor: a wrong unit. The ground is as many times too
/// far below the LiDAR, and registration sees the vehicle go as many times too fast. A wrong height of the LiDAR shows
/// in the first alone, a wrong wheel radius in the second. Reports only. A function of the calls. Pure; one thread.
/// Counters: faults.lidar.range_scale (times that it began).
class RangeScale {
 public:
  static constexpr double kStretch = 0.4;  ///< m by odometry
  static constexpr std::size_t kMinStretches = 5;
  static constexpr std::size_t kStretches = 15;
  static constexpr double kWrong = 0.15;   ///< from 1
  static constexpr double kAgree = 0.1;    ///< share by which both may differ
  static constexpr double kSpread = 0.05;  ///< of the scale: half of the middle half of the stretches

  explicit RangeScale(double lidar_height) : height_(lidar_height) {}

  /// Takes the next revolution that fitted the map.
  void add(const mounting::RegisteredScan& scan);
  /// The next revolution is not compared with earlier ones.
  void interrupt() { begin_.reset(); }
  /// By which the ranges are multiplied; nothing if they are right.
  [[nodiscard]] std::optional<double> scale() const { return scale_; }
  void add_faults(std::vector<std::string>& faults) const;
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  struct Begin {
    Pose T_map_base, T_odom_base;
  };
  [[nodiscard]] std::optional<double> scale_by_ground(const std::vector<scan::LidarPoint>& points) const;
  void judge();

  double height_;  // m
  std::optional<Begin> begin_;
  std::deque<double> by_way_, by_ground_;
  std::optional<double> scale_;
  Counters counters_;
};

}  // namespace curbstone::mapper::detection
