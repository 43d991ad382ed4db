#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

namespace curbstone::mapper {

/// For how long, and how far, a vehicle has been sought in vain of which nothing tells how it moved for a while. It may
/// be in sight of the map still, so it is sought at several places; one that stands is not given up. A value, pure.
class VainSearch {
 public:
  /// Another scan that shows something, in which it was not found, ended at `utime`, us. `in_odom`: where it was then
  /// by odometry, m; nothing if that is not known.
  void add(std::int64_t utime, const std::optional<Eigen::Vector3d>& in_odom) {
    const double dt = last_ == 0 ? 0 : static_cast<double>(utime - last_) * 1e-6;
    const bool in_step = dt > 0 && dt <= kLongestStep;
    const double went = in_odom && in_odom_ ? (*in_odom - *in_odom_).norm() : -1;
    const bool is_guided = went >= 0 && went <= kMaxSpeed * dt;  // else it is another odom frame
    if (in_step) (is_guided ? guided_ : unguided_) += dt;
    if (in_step && is_guided) path_ += went;
    last_ = utime;
    in_odom_ = in_odom;
  }

  /// s that have been searched.
  [[nodiscard]] double seconds() const { return guided_ + unguided_; }
  /// It is not in sight of what has been mapped.
  [[nodiscard]] bool is_hopeless() const { return (seconds() >= kLong && path_ >= kFar) || unguided_ >= kLongUnguided; }

 private:
  static constexpr double kLong = 12;          // s, some six searches everywhere, and
  static constexpr double kFar = 24;           // m by odometry; or,
  static constexpr double kLongUnguided = 24;  // s, where nothing says how far
  static constexpr double kLongestStep = 1;    // s between two scans
  static constexpr double kMaxSpeed = 60;      // m/s

  std::int64_t last_ = 0;  // us; 0: none
  std::optional<Eigen::Vector3d> in_odom_;
  double guided_ = 0;    // s, by odometry
  double unguided_ = 0;  // s
  double path_ = 0;      // m
};

}  // namespace curbstone::mapper
