// The filter's corrections: an interval of the wheels, standstill, the non-holonomic constraint, the map.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "services/ekf/filter/covariance_inflation.hpp"
#include "services/ekf/filter/filter.hpp"
#include "services/ekf/filter/leap_correction.hpp"

namespace curbstone::ekf::filter {

namespace {

constexpr double kMaxAxleError = 4.0;  // sigma: farther from the configured place it was learnt from wrong data
constexpr double kFreshDispute = 0.5;  // s for which a filter that has just been levelled may refuse the wheels

/// An observation without effect.
model::Observation no_observation() {
  model::Observation z(1);
  z.R(0, 0) = 1.0;
  return z;
}

}  // namespace

void Filter::correct_with_wheels(WheelStep step, bool coasting) {
  switch (step) {
    case WheelStep::kOpen:
      return;
    case WheelStep::kGap:
      counters_.add("gaps.wheels");
      break;
    case WheelStep::kNonsense:
      counters_.add("refused.wheel_jump");
      break;
    case WheelStep::kFirst:
      break;
    case WheelStep::kInterval: {
      const inputs::WheelInterval& interval = odometer_.interval();
      const bool covered = mechanisation_.window().duration() > 0.5 * interval.duration();
      if (covered && !coasting)
        compare_yaw_rates(interval);
      else
        reset_yaw_rate_comparison();
      if (covered && standing_)
        correct_standing();
      else if (covered && coasting)
        correct_coasting(interval);
      else if (covered)
        correct_driving(interval);
      mechanisation_.window().reset();
      if (launch_) launch_->begin_interval();
      return;
    }
  }
  slip_.reset_detector();
  watch_.interrupt();
  reset_yaw_rate_comparison();
  mechanisation_.window().reset();
  if (launch_) launch_->begin_interval();
}

void Filter::compare_yaw_rates(const inputs::WheelInterval& interval) {
  const double by_wheels = model::wheel_yaw_rate(belief_.mean, interval.speed, geometry_);
  const double by_gyro = mechanisation_.window().motion().angular_rate.z();
  turn_.add(interval.duration(), by_wheels, by_gyro);
  compare_tilt(interval);
  if (axes_.any() || watch_.faulty(0) || watch_.faulty(1)) return gyro_leap_.interrupt();
  const auto leap = gyro_leap_.add(interval.duration(), model::wheel_yaw_rate({}, interval.speed, geometry_),
                                   mechanisation_.window().gyro().z(), belief_.mean);
  if (leap) correct_gyro_leap(*leap);
}

/// Corrects a leap of the gyro's bias: removes its effect on heading and position since then.
void Filter::correct_gyro_leap(const detection::GyroLeap::Leap& leap) {
  counters_.add("gyro_leaps");
  gyro_leapt_ = {belief_.utime, leap.rate, 2};
  const Pose before = model::base_pose(belief_.mean, geometry_);
  belief_ = without_leap(belief_, leap);
  smoother_.corrected(before, model::base_pose(belief_.mean, geometry_));
  restart_comparisons();
}

/// Corrects a leap of the gyro's bias about a level axis. A second one soon after the first is what that left.
void Filter::compare_tilt(const inputs::WheelInterval& interval) {
  if (axes_.any() || !level_.level()) return tilting_gyro_.interrupt();
  const model::MotionWindow& window = mechanisation_.window();
  const Eigen::Vector3d along(trusted_speed(interval), 0, 0);
  const Eigen::Vector3d turn(0, 0, window.motion().angular_rate.z());
  const auto leap =
      tilting_gyro_.add({interval.duration(), along - turn.cross(geometry_.to_base), window.gyro(), window.force()},
                        belief_.mean, noise_);
  if (!leap) return;
  constexpr double kSameLeap = 10.0;  // s
  const int axis = std::abs(leap->rate.x()) > std::abs(leap->rate.y()) ? 0 : 1;
  const bool again =
      gyro_leapt_ && gyro_leapt_->axis == axis && base::seconds_between(gyro_leapt_->utime, belief_.utime) < kSameLeap;
  if (!again) counters_.add("gyro_leaps");
  gyro_leapt_ = {belief_.utime, leap->rate[axis] + (again ? gyro_leapt_->rate : 0.0), axis};
  const Pose before = model::base_pose(belief_.mean, geometry_);
  belief_ = without_tilt(belief_, *leap);
  smoother_.corrected(before, model::base_pose(belief_.mean, geometry_));
  const std::array<bool, 2> faulty = {watch_.faulty(0), watch_.faulty(1)};
  watch_.pardon();
  count_fault_changes(faulty);
  restart_comparisons();
}

/// After the belief was corrected for what wheels and IMU had been compared with.
void Filter::restart_comparisons() {
  slip_.reset_detector();
  slip_.accept_both();
  watch_.interrupt();
  reset_yaw_rate_comparison();
  cancel_launch();
}

void Filter::reset_yaw_rate_comparison() {
  turn_.interrupt();
  gyro_leap_.interrupt();
  tilting_gyro_.interrupt();
}

/// Refuses wheels that a launch disowns until they agree or are found faulty.
void Filter::check_launch(const inputs::WheelInterval& interval) {
  if (!launch_ && !wheels_rejected_) return;
  std::array<double, 2> sigma{};
  for (std::size_t wheel = 0; wheel < 2; ++wheel)
    sigma[wheel] = inputs::wheel_sigma(config_->wheels, interval, geometry_.wheel_radius, wheel);
  if (launch_ && launch_->rejects_wheels(interval, sigma)) {
    counters_.add("launches.disowned");
    const Pose before = model::base_pose(belief_.mean, geometry_);
    belief_ = launch_->belief();
    mechanisation_ = launch_->mechanisation();
    smoother_.corrected(before, model::base_pose(belief_.mean, geometry_));
    slip_.reset_detector();
    watch_.on_filter_restored();
    launch_.reset();
    wheels_rejected_ = true;
  } else if (wheels_rejected_) {
    wheels_rejected_ = !watch_.faulty(0) && !watch_.faulty(1) &&
                       !Launch::agrees(belief_, mechanisation_.window().motion(), interval, sigma, geometry_);
  }
  if (wheels_rejected_) slip_.reject_both(interval.end);
}

/// Applies both wheels' speeds and the non-holonomic constraint in one update.
void Filter::correct_driving(const inputs::WheelInterval& interval) {
  check_launch(interval);
  const model::BodyMotion motion = mechanisation_.window().motion();
  std::array<model::Observation, 2> rows = observe_wheels(interval, motion);
  check_wheels(interval, rows);
  if (axes_.yaw_rate_unmeasured() && (watch_.faulty(0) || watch_.faulty(1))) heading_.lose();
  heading_.propagate(belief_, motion.velocity.x() * interval.duration());
  const bool refused = gate_wheels(interval, rows);
  apply(model::stack(model::stack(rows[0], rows[1]), observe_constraint(motion)));
  reset_implausible_axle();
  if (is_motion_wrong(motion, refused)) {
    reset_motion(trusted_speed(interval) - motion.velocity.x());
    detection::reset_wheel_scale(belief_, config_->wheels);
    slip_.accept_both();
  }
}

std::array<model::Observation, 2> Filter::observe_wheels(const inputs::WheelInterval& interval,
                                                         const model::BodyMotion& motion) const {
  const auto observe = [&](std::size_t wheel) {
    return model::observe_wheel(belief_.mean, motion, static_cast<model::Wheel>(wheel), interval.speed[wheel],
                                inputs::wheel_sigma(config_->wheels, interval, geometry_.wheel_radius, wheel),
                                geometry_);
  };
  return {observe(0), observe(1)};
}

/// Leaves out a wheel that is faulty or slips, and softens one beyond the gate. Returns true if no wheel is left,
/// though not both are faulty.
bool Filter::gate_wheels(const inputs::WheelInterval& interval, std::array<model::Observation, 2>& rows) {
  bool refused = !watch_.all_faulty();
  for (std::size_t wheel = 0; wheel < 2; ++wheel) {
    const bool faulty = watch_.faulty(wheel);
    const bool slipping = slip_.slipping(wheel, interval.end);
    refused = refused && (faulty || slipping);
    if (faulty) counters_.add(wheel == 0 ? "withheld.wheel_left" : "withheld.wheel_right");
    if (faulty || slipping)
      rows[wheel] = no_observation();
    else if (!model::inflate_noise_beyond(model::kGate1, belief_, rows[wheel]))
      counters_.add(wheel == 0 ? "gated.wheel_left" : "gated.wheel_right");
  }
  return refused;
}

void Filter::reset_implausible_axle() {
  const bool implausible =
      std::abs(belief_.mean.axle - config_->wheels.axle) > kMaxAxleError * config_->wheels.axle_sigma ||
      belief_.mean.course.cwiseAbs().maxCoeff() > kMaxAxleError * config_->wheels.course_sigma;
  if (!implausible) return;
  counters_.add("reset.axle");
  detection::reset_axle(belief_, config_->wheels);
}

/// Whether the filter's motion is wrong: the wheels have been refused for long and are not at fault, or the speed is
/// beyond any vehicle's. Wheels that are refused as soon as the filter is level are not at fault: it was levelled
/// wrong.
bool Filter::is_motion_wrong(const model::BodyMotion& motion, bool refused) {
  const bool fresh = level_.is_fresh(belief_.utime);
  const bool disputed = wheels_refused_.expired(refused, belief_.utime, fresh ? kFreshDispute : config_->slip.patience);
  const bool absurd = motion.velocity.norm() > config_->wheels.max_speed;
  const bool doubted = disputed && (fresh || resolve_dispute() == wheel_faults::WheelWatch::Finding::kFilterWrong);
  return doubted || absurd;
}

/// Decides which wheels slip, and which are faulty.
void Filter::check_wheels(const inputs::WheelInterval& interval, const std::array<model::Observation, 2>& rows) {
  const std::array<bool, 2> before = {watch_.faulty(0), watch_.faulty(1)};
  if (watch_.finds_made_up(interval, mechanisation_.window().inertial_speed(), excess_.accelerometer)) {
    count_fault_changes(before);
    recover_from_made_up_wheels(interval);
  }
  if (!level_.level()) {  // a tilted filter takes the wheels for slipping whenever the vehicle accelerates
    slip_.reset_detector();
    watch_.interrupt();
    return;
  }
  const std::array<double, 2> distances = {model::squared_mahalanobis(belief_, rows[0]),
                                           model::squared_mahalanobis(belief_, rows[1])};
  const std::array<bool, 2> faulty = {watch_.faulty(0), watch_.faulty(1)};
  slip_.judge(interval, distances, faulty, belief_.mean, mechanisation_.window(), counters_);
  wheel_faults::WheelObservation observation;
  observation.begin = interval.begin;
  observation.end = interval.end;
  observation.yaw_rate = mechanisation_.window().motion().angular_rate.z();
  observation.inertial_speed = mechanisation_.window().inertial_speed();
  for (std::size_t wheel = 0; wheel < 2; ++wheel) {
    const double residual = rows[wheel].residual[0];
    observation.speed[wheel] = interval.speed[wheel];
    observation.expected[wheel] = interval.speed[wheel] - residual;
    observation.sigma[wheel] = std::abs(residual) / std::sqrt(std::max(distances[wheel], 1e-12));
    observation.refused[wheel] = slip_.slipping(wheel, interval.end);
  }
  watch_.add(observation);
  count_fault_changes(faulty);
}

/// The filter may have followed made-up wheels, or doubted itself because of them. The speed is set to their earlier
/// speed plus the change that the IMU has measured since.
void Filter::recover_from_made_up_wheels(const inputs::WheelInterval& interval) {
  constexpr double kSeconds = 3.0;  // for which it may have followed them
  counters_.add("faults.wheels_made_up");
  const double change = watch_.hidden_speed_change();
  belief_.mean.velocity.x() += interval.mean_speed() + change - mechanisation_.window().motion().velocity.x();
  inflate_for_wheel_faults(belief_, {.speed = 0.3, .position = kSeconds * std::abs(change), .seconds = kSeconds},
                           config_->start);
}

void Filter::count_fault_changes(const std::array<bool, 2>& before) {
  for (std::size_t wheel = 0; wheel < 2; ++wheel) {
    if (watch_.faulty(wheel) && !before[wheel]) counters_.add(wheel == 0 ? "faults.wheel_left" : "faults.wheel_right");
    if (!watch_.faulty(wheel) && before[wheel])
      counters_.add(wheel == 0 ? "trusted.wheel_left" : "trusted.wheel_right");
  }
}

wheel_faults::WheelWatch::Finding Filter::resolve_dispute() {
  const std::array<bool, 2> faulty = {watch_.faulty(0), watch_.faulty(1)};
  const auto finding = watch_.resolve_dispute();
  count_fault_changes(faulty);
  if (finding == wheel_faults::WheelWatch::Finding::kWheelsWrong)
    inflate_for_wheel_faults(belief_, watch_.filter_error(), config_->start);
  return finding;
}

model::Observation Filter::observe_constraint(const model::BodyMotion& motion) {
  const base::WheelsConfig& c = config_->wheels;
  model::Observation lateral = model::observe_no_motion_along(1, belief_.mean, motion, c.lateral_noise, geometry_);
  model::Observation vertical = model::observe_no_motion_along(2, belief_.mean, motion, c.vertical_noise, geometry_);
  const bool lateral_fits = model::inflate_noise_beyond(model::kGate1, belief_, lateral);
  const bool vertical_fits = model::inflate_noise_beyond(model::kGate1, belief_, vertical);
  if (!lateral_fits) counters_.add("gated.lateral");
  if (!vertical_fits) counters_.add("gated.vertical");
  const bool refused = !lateral_fits || !vertical_fits;
  if (constraint_refused_.expired(refused, belief_.utime, config_->slip.patience)) {
    reset_motion(motion.velocity.tail<2>().norm());
    detection::reset_axle(belief_, c);
  }
  return model::stack(lateral, vertical);
}

/// Speed by the trusted wheels, m/s.
double Filter::trusted_speed(const inputs::WheelInterval& interval) const {
  for (std::size_t wheel = 0; wheel < 2; ++wheel) {
    if (watch_.faulty(1 - wheel) && !watch_.faulty(wheel)) return interval.speed[wheel];
  }
  return interval.mean_speed();
}

/// Corrects with the trusted wheels. Unless both are trusted, the yaw rate is unknown.
void Filter::correct_coasting(const inputs::WheelInterval& interval) {
  const model::BodyMotion motion = mechanisation_.window().motion();
  model::Observation constraint = observe_constraint(motion);
  constraint.H.middleCols<3>(model::kGyroBias).setZero();  // the rate comes from the wheels
  if (watch_.faulty(0) || watch_.faulty(1)) heading_.lose();
  heading_.propagate(belief_, motion.velocity.x() * interval.duration());
  if (watch_.all_faulty()) return apply(constraint);
  double sigma = 0.0;
  for (std::size_t wheel = 0; wheel < 2; ++wheel)
    sigma = std::max(sigma, inputs::wheel_sigma(config_->wheels, interval, geometry_.wheel_radius, wheel));
  if (watch_.faulty(0) || watch_.faulty(1))
    sigma = std::hypot(sigma, 0.5 * geometry_.track_width * model::Mechanisation::kUsualTurn);
  model::Observation forward = model::observe_forward_speed(belief_.mean, motion, trusted_speed(interval), sigma);
  if (!model::inflate_noise_beyond(model::kGate1, belief_, forward)) counters_.add("gated.forward");
  apply(model::stack(forward, constraint));
}

void Filter::correct_standing() {
  const model::MotionWindow& window = mechanisation_.window();
  const double rate_density = std::hypot(noise_.gyro, config_->standstill.rate_noise);
  model::Observation velocity = model::observe_standing_velocity(belief_.mean, config_->standstill.speed_noise);
  model::Observation rate =
      model::observe_standing_rate(belief_.mean, window.gyro(), rate_density / std::sqrt(window.duration()));
  if (!model::inflate_noise_beyond(model::kGate3, belief_, velocity)) counters_.add("gated.standing_velocity");
  if (!model::inflate_noise_beyond(model::kGate3, belief_, rate)) counters_.add("gated.standing_rate");
  apply(model::stack(velocity, rate));
}

void Filter::correct_without_wheels() {
  model::MotionWindow& window = mechanisation_.window();
  if (window.duration() < config_->wheels.interval) return;
  if (axes_.yaw_rate_unmeasured()) heading_.lose();
  apply(observe_constraint(window.motion()));
  window.reset();
}

void Filter::correct_with_map() {
  const inputs::MapIncrement increment = *std::exchange(pending_increment_, std::nullopt);
  const auto begin = recent_.at(increment.begin);
  const auto end = recent_.at(increment.utime);
  if (standing_ || !begin || !end || axes_.any()) return;  // a lost axis's rate is not constant as a bias is
  const Pose believed = begin->inverse() * *end;
  const double dt = base::seconds_between(increment.begin, increment.utime);
  const model::BodyMotion mean{believed.translation() / dt, so3_log(Eigen::Quaterniond(believed.linear())) / dt};
  model::Observation z =
      model::observe_increment(increment.T_begin_end, increment.covariance, believed, dt, mean, geometry_);
  counters_.add(model::inflate_noise_beyond(model::kGate6, belief_, z) ? "map.used" : "gated.map");
  apply(z);
}

}  // namespace curbstone::ekf::filter
