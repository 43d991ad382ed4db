#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>

namespace curbstone::ekf::mounting {

/// By how much the vehicle leans by gravity, on the average of the last kMemory of driving. Streets lean sideways by a
/// few degrees, hills by up to 15, not all along; if it is more, the IMU leans in its mount, and the map leans with it.
/// Bends, which push sideways, are left out. A value type; one thread.
class MeanLean {
 public:
  static constexpr double kMemory = 20.0;    ///< s of driving, before there is a result
  static constexpr double kMinSpeed = 0.5;   ///< m/s: by the wheels
  static constexpr double kMaxTurn = 0.08;   ///< rad/s: beyond it is a bend
  static constexpr double kSideways = 0.16;  ///< rad: a fault from here on
  static constexpr double kAhead = 0.3;      ///< rad

  /// Adds means over an interval: the specific force in base_link, m/s^2, the speed, m/s, and the yaw rate, rad/s: the
  /// larger one, of gyro and wheels.
  void add(double seconds, const Eigen::Vector3d& force, double speed, double yaw_rate) {
    if (std::abs(speed) < kMinSpeed || std::abs(yaw_rate) > kMaxTurn) return;
    seconds_ = std::min(seconds_ + seconds, kMemory);
    force_ += seconds / seconds_ * (force - force_);
  }
  /// rad, to the right and backwards, if either is too much.
  [[nodiscard]] std::optional<Eigen::Vector2d> wrong() const {
    const Eigen::Vector2d lean(std::atan2(force_.y(), force_.z()), std::atan2(force_.x(), force_.z()));
    if (seconds_ < kMemory || (std::abs(lean.x()) < kSideways && std::abs(lean.y()) < kAhead)) return {};
    return lean;
  }

 private:
  double seconds_ = 0.0;
  Eigen::Vector3d force_ = Eigen::Vector3d::Zero();  // m/s^2, mean
};

}  // namespace curbstone::ekf::mounting
