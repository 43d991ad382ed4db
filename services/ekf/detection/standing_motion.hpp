#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace curbstone::ekf::detection {

/// Detects a vehicle that drives off while its wheels seem to rest: dead encoders show no travel, and a gentle start is
/// quiet. Integrates the acceleration beyond the mean at rest (which is rotated with the gyro) to a speed. The integral
/// leaks with kMemory, so that neither a slow drift nor a slow tilt adds up to motion. Pure; one thread.
class StandingMotion {
 public:
  static constexpr double kMemory = 1.5;  ///< s
  static constexpr double kSpeed = 0.3;   ///< m/s, from which on the vehicle counts as driving

  /// Call it when the wheels turn: restarts.
  void begin() { *this = StandingMotion(); }
  /// Adds a sample in base_link's axes, `rate` minus its bias, `dt` s after the one before. Returns the speed in m/s
  /// once the vehicle drives.
  std::optional<double> add(const Eigen::Vector3d& acceleration, const Eigen::Vector3d& rate, double dt) {
    if (dt <= 0) return {};
    seconds_ += dt;
    at_rest_ -= dt * rate.cross(at_rest_);
    at_rest_ += std::min(dt / (seconds_ < kFirst ? seconds_ : kDrift), 1.0) * (acceleration - at_rest_);
    speed_ += dt * ((acceleration - at_rest_).x() - speed_ / kMemory);
    if (seconds_ < kFirst || std::abs(speed_) < kSpeed) return {};
    return std::exchange(speed_, 0.0);
  }
  /// m/s, a speed that the vehicle may have but that is not proven yet; 0: it seems to stand.
  [[nodiscard]] double suspected_speed() const {
    return seconds_ < kFirst || std::abs(speed_) < kSuspicious ? 0.0 : std::abs(speed_);
  }

 private:
  static constexpr double kSuspicious = 0.05;  // m/s: at rest the noise adds up to less
  static constexpr double kFirst = 1.0;        // s, over which the mean at rest is averaged first
  static constexpr double kDrift = 5.0;        // s, time constant with which the mean then follows
  Eigen::Vector3d at_rest_ = Eigen::Vector3d::Zero();
  double seconds_ = 0.0;
  double speed_ = 0.0;  // m/s, forward
};

}  // namespace curbstone::ekf::detection
