#pragma once

#include <optional>

#include "services/ekf/base/ekf_config.hpp"
#include "services/ekf/detection/still_detector.hpp"
#include "services/ekf/model/measurement_model.hpp"
#include "services/ekf/model/process_model.hpp"

namespace curbstone::ekf::detection {

/// Resets radii and track to the configured values, with the prior's covariance.
void reset_wheel_scale(model::Belief& belief, const base::WheelsConfig& config);
/// Resets the axle's place and course likewise.
void reset_axle(model::Belief& belief, const base::WheelsConfig& config);
/// Resets the accelerometer's bias likewise, to zero.
void reset_accelerometer_bias(model::Belief& belief, const base::StartConfig& config);

/// Computes the first belief. At standstill the mean specific force levels the attitude, and the mean rate is the
/// gyro's bias. Both are applied as measurements to a wide prior, so that the covariance holds that at rest a tilt
/// error and an accelerometer bias cannot be told apart. A vehicle that drives already is started on the move, with the
/// wheels' speed, and levelled by the specific force minus the wheels' acceleration. If no IMU is heard, it is started
/// on the wheels once they turn, as if the ground were level. base_link is the origin of odom with yaw 0 by definition,
/// so the covariance of both is zero.
class StartUp {
 public:
  enum class Kind { kStanding, kMoving, kImpatient, kWithoutImu };

  explicit StartUp(const base::EkfConfig& config);

  /// Returns a belief at the sample's time if the wheels turn and no IMU has been heard for start.patience.
  [[nodiscard]] std::optional<model::Belief> add(const base::WheelSample& sample);
  /// Sets the noise of the IMU: the process noise, and 1 sigma of a sample as in StillDetector::set_noise().
  void set_noise(const base::NoiseConfig& noise, double gyro, double accelerometer);
  /// Returns a belief at the sample's time once enough is known.
  [[nodiscard]] std::optional<model::Belief> add(const base::ImuSample& sample);
  /// s, for how long wheels have been heard without an IMU; 0 if it is heard.
  [[nodiscard]] double seconds_without_imu(std::int64_t utime) const {
    return without_imu_ ? base::seconds_between(*without_imu_, utime) : 0.0;
  }
  /// How the filter was started; valid once it was.
  [[nodiscard]] Kind kind() const { return kind_; }
  void reset();

 private:
  [[nodiscard]] model::Belief standing(std::int64_t utime) const;
  /// `mean`: of the IMU, body axes, while the wheels moved as in the window.
  [[nodiscard]] model::Belief moving(std::int64_t utime, const model::Inertial& mean) const;
  [[nodiscard]] model::Inertial measured() const;
  [[nodiscard]] model::Inertial on_level_ground() const;
  [[nodiscard]] model::Belief prior(std::int64_t utime, const Eigen::Vector3d& up) const;
  void fix_origin(model::Belief& belief) const;

  base::EkfConfig config_;
  model::Geometry geometry_;
  StillDetector standing_window_;
  StillDetector moving_window_;
  std::optional<std::int64_t> since_;        // us, first IMU sample
  std::optional<std::int64_t> without_imu_;  // us, first wheel sample after the newest IMU sample
  Kind kind_ = Kind::kStanding;
};

}  // namespace curbstone::ekf::detection
