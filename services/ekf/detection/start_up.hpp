#pragma once

#include <optional>

#include "services/ekf/base/ekf_config.hpp"
#include "services/ekf/detection/still_detector.hpp"
#include "services/ekf/model/measurement_model.hpp"

namespace curbstone::ekf::detection {

/// Radii and track as configured, with the prior's covariance.
void forget_wheel_scale(model::Belief& belief, const base::WheelsConfig& config);
/// Likewise the axle's place and course.
void forget_axle(model::Belief& belief, const base::WheelsConfig& config);
/// Likewise the accelerometer's bias: none.
void forget_accelerometer_bias(model::Belief& belief, const base::StartConfig& config);

/// Finds the first belief. At standstill the mean specific force levels the attitude and the mean rate is the gyro's
/// bias; both are applied as measurements to a wide prior, so that the covariance knows that a tilt error and an
/// accelerometer bias are one and the same at rest. A vehicle that drives already is started on the move, with the
/// wheels' speed and, for gravity, what is left of the specific force without the wheels' acceleration.
/// base_link is the origin of odom, and its yaw is 0, by definition: their covariance is zero.
class StartUp {
 public:
  enum class Kind { kStanding, kMoving, kImpatient };

  explicit StartUp(const base::EkfConfig& config);

  void add(const base::WheelSample& sample);
  /// How noisy the IMU is: what disturbs the prediction, and 1 sigma of its samples as of StillDetector::set_noise().
  void set_noise(const base::NoiseConfig& noise, double gyro, double accelerometer);
  /// A belief at the sample's time once enough is known.
  [[nodiscard]] std::optional<model::Belief> add(const base::ImuSample& sample);
  /// How it went, once started.
  [[nodiscard]] Kind kind() const { return kind_; }
  void reset();

 private:
  [[nodiscard]] model::Belief standing(std::int64_t utime) const;
  [[nodiscard]] model::Belief moving(std::int64_t utime) const;
  [[nodiscard]] model::Belief prior(std::int64_t utime, const Eigen::Vector3d& up) const;
  void fix_origin(model::Belief& belief) const;

  base::EkfConfig config_;
  model::Geometry geometry_;
  StillDetector standing_window_;
  StillDetector moving_window_;
  std::optional<std::int64_t> since_;  // us, first IMU sample
  Kind kind_ = Kind::kStanding;
};

}  // namespace curbstone::ekf::detection
