#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

namespace curbstone::mapper {

/// Time and distance of an unsuccessful search for a lost vehicle whose motion no sensor measured for a while. The
/// vehicle may still be in sight of the map, so it is searched for at several places; a vehicle that stands by odometry
/// is not given up. A value, pure.
class FailedSearch {
 public:
  /// Adds a scan with enough points that ended at `utime`, us, and in which the vehicle was not found. `in_odom`: the
  /// vehicle's position in the odom frame at that time, m; nothing if unknown.
  void add(std::int64_t utime, const std::optional<Eigen::Vector3d>& in_odom) {
    const double dt = last_ == 0 ? 0 : static_cast<double>(utime - last_) * 1e-6;
    const bool in_step = dt > 0 && dt <= kMaxStep;
    const double went = in_odom && in_odom_ ? (*in_odom - *in_odom_).norm() : -1;
    const bool is_guided = went >= 0 && went <= kMaxSpeed * dt;  // else the odom frame is a new one
    if (in_step) (is_guided ? guided_ : unguided_) += dt;
    if (in_step && is_guided) path_ += went;
    last_ = utime;
    in_odom_ = in_odom;
  }

  /// Duration of the search, s.
  [[nodiscard]] double seconds() const { return guided_ + unguided_; }
  /// The vehicle is not in sight of what has been mapped: the search should end.
  [[nodiscard]] bool is_hopeless() const {
    return (seconds() >= kMinDuration && path_ >= kMinPath) || unguided_ >= kMaxUnguided;
  }

 private:
  static constexpr double kMinDuration = 12;  // s, later than LostTimer; about six searches of the whole map, and
  static constexpr double kMinPath = 24;      // m by odometry, or
  static constexpr double kMaxUnguided = 24;  // s without odometry
  static constexpr double kMaxStep = 1;       // s between two scans that are counted
  static constexpr double kMaxSpeed = 60;     // m/s; a faster one is a jump of the odom frame

  std::int64_t last_ = 0;  // us; 0: none
  std::optional<Eigen::Vector3d> in_odom_;
  double guided_ = 0;    // s of the search with odometry
  double unguided_ = 0;  // s without
  double path_ = 0;      // m by odometry
};

}  // namespace curbstone::mapper
