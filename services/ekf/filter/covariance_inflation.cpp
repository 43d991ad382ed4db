#include "services/ekf/filter/covariance_inflation.hpp"

#include <algorithm>
#include <cmath>

#include "services/ekf/detection/standing_motion.hpp"
#include "services/ekf/detection/start_up.hpp"

namespace curbstone::ekf::filter {

namespace {

void widen(model::Belief& belief, int index, double sigma) {
  belief.covariance.diagonal().segment<3>(index).array() += sigma * sigma;
}

/// m, distance of a vehicle that accelerates evenly to `speed` within StandingMotion's memory.
double distance_since_standing(double speed) {
  return 0.5 * speed * detection::StandingMotion::kMemory;
}

}  // namespace

void inflate_motion_covariance(model::Belief& belief, double speed_sigma, const base::StartConfig& config) {
  widen(belief, model::kVelocity, speed_sigma);
  widen(belief, model::kAttitude, config.moving_tilt_sigma);
  detection::reset_accelerometer_bias(belief, config);
}

void inflate_over_gap(model::Belief& belief, double gap, const base::StartConfig& config) {
  const double speed = std::max(1.0, belief.mean.velocity.norm());
  widen(belief, model::kPosition, speed * std::clamp(gap, 0.0, 10.0));
  widen(belief, model::kVelocity, speed);
  widen(belief, model::kAttitude, config.moving_tilt_sigma);
}

/// A heading that is much less certain than roll and pitch is not inflated for nothing: as soon as roll and pitch are
/// corrected, its axis is not quite the one of the covariance, and the next correction of a thousandth of a radian
/// turns it by degrees.
void extrapolate_over_restart(model::Belief& belief, double gap, std::optional<double> turn_rate) {
  constexpr double kAcceleration = 3.0;      // m/s^2
  constexpr double kTilting = 0.02;          // rad/s
  constexpr double kTurning = 0.5;           // rad/s, about the vertical: no measurement corrects it
  constexpr double kTurnAcceleration = 0.5;  // rad/s^2
  const auto turned_by = [](double angle) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()));
  };
  const double rate = turn_rate.value_or(0.0);
  const double heading_sigma = turn_rate ? 0.5 * kTurnAcceleration * gap * gap : kTurning * gap;
  belief.mean.position += turned_by(0.5 * rate * gap) * (belief.mean.attitude * belief.mean.velocity) * gap;
  belief.mean.attitude = turned_by(rate * gap) * belief.mean.attitude;
  const Eigen::Vector3d yaw_axis = belief.mean.attitude.conjugate() * Eigen::Vector3d::UnitZ();
  widen(belief, model::kPosition, 0.5 * kAcceleration * gap * gap + heading_sigma * belief.mean.velocity.norm() * gap);
  widen(belief, model::kVelocity, kAcceleration * gap);
  widen(belief, model::kAttitude, kTilting * gap);
  belief.covariance.block<3, 3>(model::kAttitude, model::kAttitude) +=
      heading_sigma * heading_sigma * yaw_axis * yaw_axis.transpose();
}

void inflate_after_standstill(model::Belief& belief, double travel, double track_width) {
  const double moved = travel / std::sqrt(3.0);
  const double turned = travel / std::sqrt(6.0) / track_width;
  const Eigen::Vector3d yaw_axis = belief.mean.attitude.conjugate() * Eigen::Vector3d::UnitZ();
  widen(belief, model::kPosition, moved);
  belief.covariance.block<3, 3>(model::kAttitude, model::kAttitude) +=
      turned * turned * yaw_axis * yaw_axis.transpose();
}

void set_speed_after_missed_start(model::Belief& belief, double speed) {
  constexpr double kShare = 0.15;  // of the speed
  belief.mean.velocity.x() = speed;
  widen(belief, model::kVelocity, kShare * speed);
  widen(belief, model::kPosition, distance_since_standing(speed));
}

void inflate_for_suspected_motion(model::Estimate& estimate, double speed) {
  const double distance = distance_since_standing(speed);
  estimate.pose_covariance.diagonal().head<2>().array() += distance * distance;
  estimate.twist_covariance(0, 0) += speed * speed;
}

void inflate_for_wheel_faults(model::Belief& belief, const wheel_faults::WheelDispute::FilterError& error,
                              const base::StartConfig& config) {
  constexpr double kCoastingBias = 0.015;  // m/s^2, 1.5 milli-g: error that no wheel corrects while coasting
  widen(belief, model::kAccelerometerBias, kCoastingBias);
  if (error.speed <= 0) return;
  const double acceleration = kGravity * config.level_sigma;  // error due to the tilt since then
  const double since = error.seconds;
  widen(belief, model::kVelocity, std::hypot(error.speed, acceleration * since));
  widen(belief, model::kPosition, std::hypot(error.position, 0.5 * acceleration * since * since));
  widen(belief, model::kAttitude, config.level_sigma);
  widen(belief, model::kAccelerometerBias, config.accelerometer_bias_sigma);
}

bool is_finite(const model::Belief& belief) {
  const model::NavState& x = belief.mean;
  return belief.covariance.allFinite() && x.position.allFinite() && x.velocity.allFinite() &&
         x.attitude.coeffs().allFinite() && x.gyro_bias.allFinite() && x.accelerometer_bias.allFinite() &&
         x.wheel_scale.allFinite() && std::isfinite(x.axle) && x.course.allFinite();
}

}  // namespace curbstone::ekf::filter
