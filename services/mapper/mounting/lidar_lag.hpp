#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"
#include "common/geometry/geometry.hpp"

namespace curbstone::mapper::mounting {

/// Estimates the delay of the LiDAR's stamps against odometry's. When a bend begins or ends, registration shows the
/// same turn as odometry, shifted by the delay. The turns of both, over kSpan, are correlated at shifted times. An
/// estimate is made as soon as the vehicle has turned enough for a sigma of kMaxSigma; the result is the median of the
/// estimates, if they agree. A rate or scale error of a gyro does not shift the result. A vehicle that stands or drives
/// straight on gives no estimate.
///
/// Keeps the last kMaxEstimates estimates. A function of the calls. Pure; one thread. Counters: faults.lidar.late
/// (times that the stamps were found wrong), lidar.lag_ms (level: once it is known).
class LidarLag {
 public:
  static constexpr std::int64_t kMaxShift = 600'000;  ///< us: largest shift that is tested, either way
  static constexpr std::int64_t kStep = 20'000;       ///< us, between tested shifts
  static constexpr std::int64_t kSpan = 500'000;      ///< us
  static constexpr double kMaxSigma = 0.01;           ///< s, 1 sigma of an estimate
  static constexpr std::size_t kMinEstimates = 3;     ///< estimates before there is a result
  static constexpr std::size_t kMaxEstimates = 9;
  static constexpr double kWrong = 0.04;    ///< s: a fault is raised from here on,
  static constexpr double kSettled = 0.75;  ///< and cleared below this share of it

  LidarLag() : correlations_(2 * kMaxShift / kStep + 1) {}
  /// Adds the next revolution: its pose by registration, and the pose by odometry at its stamp.
  void add(std::int64_t utime, const Pose& T_map_base, const Pose& T_odom_base);
  /// Breaks the sequence: the next revolution is not compared with earlier ones.
  void interrupt() { turned_.clear(); }

  /// s; negative if the stamps are early. None before kMinEstimates estimates, or if they do not agree.
  [[nodiscard]] std::optional<double> lag() const;
  [[nodiscard]] bool wrong() const { return wrong_; }
  void add_faults(std::vector<std::string>& faults) const;
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  /// rad about the vertical since the sequence began.
  struct Turned {
    std::int64_t utime = 0;
    double by_scans = 0, by_odometry = 0;
  };
  /// Correlation of the turns by registration with the turns by odometry at shifted times.
  struct Correlation {
    double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
    void add(double by_odometry, double by_scans);
    /// rad^2: the part of one that no scale and rate of the other explains.
    [[nodiscard]] double unexplained() const;
  };
  [[nodiscard]] double over(double Turned::*by, std::int64_t utime) const;
  [[nodiscard]] std::optional<double> estimate() const;
  void judge();

  std::deque<Turned> turned_;
  Pose T_map_base_ = Pose::Identity(), T_odom_base_ = Pose::Identity();  // of the last revolution
  std::vector<Correlation> correlations_;                                // for each shift, since the last estimate
  std::deque<double> estimates_;                                         // s
  bool wrong_ = false;
  Counters counters_;
};

}  // namespace curbstone::mapper::mounting
