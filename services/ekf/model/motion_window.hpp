#pragma once

#include "services/ekf/model/measurement_model.hpp"

namespace curbstone::ekf::model {

/// Means of the filter's motion between two corrections: the wheels' mean speed is compared with this mean and not with
/// the newest value, so that braking does not look like an error.
class MotionWindow {
 public:
  /// `motion` and `imu` (body axes) as means over `dt` seconds; `inertial_speed` see SlipDetector.
  void add(double dt, const BodyMotion& motion, const Inertial& imu, double inertial_speed) {
    duration_ += dt;
    velocity_ += dt * motion.velocity;
    rate_ += dt * motion.angular_rate;
    gyro_ += dt * imu.angular_rate;
    force_ += dt * imu.acceleration;
    inertial_speed_ += dt * inertial_speed;
  }
  void reset() { *this = {}; }

  [[nodiscard]] double duration() const { return duration_; }
  // Only for a duration > 0.
  [[nodiscard]] BodyMotion motion() const { return {velocity_ / duration_, rate_ / duration_}; }
  [[nodiscard]] Eigen::Vector3d gyro() const { return gyro_ / duration_; }
  [[nodiscard]] Eigen::Vector3d force() const { return force_ / duration_; }
  [[nodiscard]] double inertial_speed() const { return inertial_speed_ / duration_; }

 private:
  double duration_ = 0.0;  // s
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d rate_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d gyro_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d force_ = Eigen::Vector3d::Zero();  // m/s^2, specific
  double inertial_speed_ = 0.0;
};

}  // namespace curbstone::ekf::model
