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

/// How late the LiDAR's stamps are against odometry's. In a bend that begins or ends registration shows the turn that
/// odometry showed so much earlier: the turns of both, over kOver, are correlated at shifted times. An estimate is
/// made as soon as what was driven has turned enough for one that is sure to kSure; the median of those that agree is
/// said. Gyros that are off by a rate or a scale shift nothing. A vehicle that stands or drives straight on tells
/// nothing.
///
/// Remembers the last kMost estimates. A function of the calls. Pure; one thread. Counters: faults.lidar.late (times
/// that its stamps were found wrong), lidar.lag_ms (level: once it is known).
class LidarLag {
 public:
  static constexpr std::int64_t kReach = 600'000;  ///< us, that are looked for to either side
  static constexpr std::int64_t kStep = 20'000;    ///< us, between two that are
  static constexpr std::int64_t kOver = 500'000;   ///< us
  static constexpr double kSure = 0.01;            ///< s, 1 sigma of an estimate
  static constexpr std::size_t kLeast = 3;         ///< estimates before anything is said
  static constexpr std::size_t kMost = 9;
  static constexpr double kWrong = 0.04;    ///< s, from which it is a fault,
  static constexpr double kSettled = 0.75;  ///< and of this share no more

  LidarLag() : correlations_(2 * kReach / kStep + 1) {}
  /// The next revolution: where registration has it, and where odometry at the time that it is stamped with.
  void add(std::int64_t utime, const Pose& T_map_base, const Pose& T_odom_base);
  /// What comes now has nothing to do with what came before.
  void interrupt() { turned_.clear(); }

  /// s; below 0 the stamps are early. Nothing before kLeast estimates, or where they do not agree.
  [[nodiscard]] std::optional<double> lag() const;
  [[nodiscard]] bool wrong() const { return wrong_; }
  void add_faults(std::vector<std::string>& faults) const;
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  /// rad about the vertical since a beginning.
  struct Turned {
    std::int64_t utime = 0;
    double by_scans = 0, by_odometry = 0;
  };
  /// Of the turns by scans with those by odometry at other times.
  struct Correlation {
    double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
    void add(double by_odometry, double by_scans);
    /// rad^2: what no scale and no rate makes of the one the other.
    [[nodiscard]] double unexplained() const;
  };
  [[nodiscard]] double over(double Turned::*by, std::int64_t utime) const;
  [[nodiscard]] std::optional<double> estimate() const;
  void judge();

  std::deque<Turned> turned_;
  Pose T_map_base_ = Pose::Identity(), T_odom_base_ = Pose::Identity();  // of the last revolution
  std::vector<Correlation> correlations_;                                // for each lag, since the last estimate
  std::deque<double> estimates_;                                         // s
  bool wrong_ = false;
  Counters counters_;
};

}  // namespace curbstone::mapper::mounting
