#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace curbstone::ekf::detection {

/// Whether a vehicle whose wheels rest drives off: encoders that are dead show no travel, and a gentle start is quiet.
/// What the accelerometer feels beyond what it felt at rest, turned as the gyro turns, adds up to a speed; what lies
/// kMemory back is forgotten, so that neither a slow drift nor a slow tilt does. Pure; one thread.
class StandingMotion {
 public:
  static constexpr double kMemory = 1.5;  ///< s
  static constexpr double kSpeed = 0.3;   ///< m/s, from which on it drives

  /// The wheels turn.
  void begin() { *this = StandingMotion(); }
  /// A sample in base_link's axes, `rate` less its bias, `dt` s after the one before. Its speed, once it drives.
  std::optional<double> add(const Eigen::Vector3d& acceleration, const Eigen::Vector3d& rate, double dt) {
    if (dt <= 0) return {};
    seconds_ += dt;
    at_rest_ -= dt * rate.cross(at_rest_);
    at_rest_ += std::min(dt / (seconds_ < kFirst ? seconds_ : kDrift), 1.0) * (acceleration - at_rest_);
    speed_ += dt * ((acceleration - at_rest_).x() - speed_ / kMemory);
    if (seconds_ < kFirst || std::abs(speed_) < kSpeed) return {};
    return std::exchange(speed_, 0.0);
  }
  /// m/s, that it may drive at though that is not sure yet; 0: it seems to stand.
  [[nodiscard]] double suspected_speed() const {
    return seconds_ < kFirst || std::abs(speed_) < kSuspicious ? 0.0 : std::abs(speed_);
  }

 private:
  static constexpr double kSuspicious = 0.05;  // m/s: at rest its noise adds up to less
  static constexpr double kFirst = 1.0;        // s, over which what it feels at rest is averaged first,
  static constexpr double kDrift = 5.0;        // and in which it is learnt anew
  Eigen::Vector3d at_rest_ = Eigen::Vector3d::Zero();
  double seconds_ = 0.0;
  double speed_ = 0.0;  // m/s, forward
};

}  // namespace curbstone::ekf::detection
