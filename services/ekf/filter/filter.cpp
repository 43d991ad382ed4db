#include "services/ekf/filter/filter.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "services/ekf/filter/covariance_inflation.hpp"

namespace curbstone::ekf::filter {

namespace {

constexpr std::size_t kRecent = 1024;  // poses: 2.5 s at 400 Hz
constexpr double kMaxForce = 5.0;      // m/s^2: braking and rough roads; more means that the vehicle lies on its side
constexpr std::size_t kMaxPending = 256;  // wheel samples between two IMU samples

const char* name_of(detection::StartUp::Kind kind) {
  switch (kind) {
    case detection::StartUp::Kind::kStanding:
      return "starts.standing";
    case detection::StartUp::Kind::kMoving:
      return "starts.moving";
    case detection::StartUp::Kind::kWithoutImu:
      return "starts.without_imu";
    default:
      return "starts.impatient";
  }
}

}  // namespace

Filter::Filter(const base::EkfConfig& config)
    : config_(std::make_shared<const base::EkfConfig>(config)),
      geometry_(config.vehicle),
      noise_(config.noise),
      start_up_(config),
      still_(config.standstill, config.vehicle.wheel_radius, config.timing.max_wheel_gap),
      odometer_(config.wheels, config.vehicle.wheel_radius, config.timing.max_wheel_gap),
      mechanisation_(config, geometry_),
      slip_(config.slip, geometry_),
      watch_(config.slip, config.vehicle.track_width),
      smoother_(config.spread),
      recent_(kRecent),
      axes_(config, geometry_) {}

model::TimedInertial Filter::in_body(const base::ImuSample& sample) const {
  return {sample.utime, {geometry_.R_base_imu * sample.angular_rate, geometry_.R_base_imu * sample.acceleration}};
}

void Filter::add(const base::ImuSample& measured, std::vector<model::Estimate>& out) {
  const base::ImuSample sample = usable_of(measured);
  if (!started_) {
    start(sample);
    if (!started_) return;
  }
  if (sample.turned != belief_.imu_turn) turn_imu(sample.turned);
  const model::TimedInertial next = in_body(sample);
  const double gap = base::seconds_between(belief_.utime, sample.utime);
  if (gap < 0.0 || gap > config_->timing.max_jump) restart_clock(sample.utime);
  update_stuck_axes();
  const auto& last = mechanisation_.last_imu();
  const double dt = last ? base::seconds_between(last->utime, sample.utime) : 0.0;
  const bool first_or_again = !last || dt > config_->timing.max_imu_gap;
  if (first_or_again && !level_.level()) level_.begin(false, sample.utime);  // it has not been able to level itself
  if (dt > config_->timing.max_imu_gap) {
    counters_.add("gaps.imu");
    watch_.interrupt();
    reset_yaw_rate_comparison();
    leave_standing();
    still_.reset();
  }
  still_.add(sample);
  process_pending_wheels(&next);
  mechanisation_.advance(belief_, sample.utime, &next, standing_);
  advance_launch(sample.utime, &next);
  mechanisation_.set_last_imu(next);
  if (launch_) launch_->set_last_imu(next);
  update_standing(next.imu, dt);
  if (wheels_missing(sample.utime)) correct_without_wheels();
  restore_if_not_finite();
  update_level();
  emit(next.imu, dt, false, out);
  if (pending_increment_ && pending_increment_->utime <= sample.utime) correct_with_map();
}

void Filter::add(const base::WheelSample& sample, std::vector<model::Estimate>& out) {
  last_wheels_ = sample.utime;
  still_.add(sample);
  if (!started_) return start(sample);
  const double gap = base::seconds_between(belief_.utime, sample.utime);
  if (gap < 0.0 || gap > config_->timing.max_jump) {
    restart_clock(sample.utime);
    last_wheels_ = sample.utime;
  }
  pending_.push_back(sample);
  if (!mechanisation_.imu_at_hand(sample.utime)) {
    if (standing_) leave_standing();
    process_pending_wheels(nullptr);
    restore_if_not_finite();
    const model::Inertial steady{
        belief_.mean.gyro_bias + Eigen::Vector3d(0, 0, mechanisation_.wheel_yaw_rate()),
        belief_.mean.accelerometer_bias + belief_.mean.attitude.conjugate() * Eigen::Vector3d(0, 0, kGravity)};
    emit(steady, 0.0, true, out);
  } else if (pending_.size() > kMaxPending) {
    counters_.add("dropped.pending");
    pending_.pop_front();
  }
}

bool Filter::continue_from_predecessor(const base::ImuSample& sample) {
  const std::optional<model::Belief> predecessor = std::exchange(predecessor_, std::nullopt);
  if (!predecessor) return false;
  const double gap = base::seconds_between(predecessor->utime, sample.utime);
  const Eigen::Vector3d force = geometry_.R_base_imu * sample.acceleration - predecessor->mean.accelerometer_bias;
  const Eigen::Vector3d up = predecessor->mean.attitude.conjugate() * Eigen::Vector3d(0, 0, kGravity);
  if (gap <= 0.0 || gap > kInheritance || (force - up).norm() > kMaxForce) {
    counters_.add("starts.not_inherited");
    return false;
  }
  std::optional<double> turn_rate;
  if (sample.stuck == std::array<bool, 3>{})
    turn_rate = (geometry_.R_base_imu * sample.angular_rate - predecessor->mean.gyro_bias).dot(up.normalized());
  continue_from(*predecessor, sample.utime, turn_rate);
  return true;
}

/// The predecessor had no IMU either, or it has fallen silent meanwhile.
bool Filter::continue_from_predecessor(const base::WheelSample& sample) {
  if (!predecessor_ || start_up_.seconds_without_imu(sample.utime) < kImuAwaited) return false;
  const model::Belief predecessor = *std::exchange(predecessor_, std::nullopt);
  const double gap = base::seconds_between(predecessor.utime, sample.utime);
  if (gap <= 0.0 || gap > kInheritance) {
    counters_.add("starts.not_inherited");
    return false;
  }
  continue_from(predecessor, sample.utime, std::nullopt);
  return true;
}

/// A vehicle in a bend goes on turning while no process runs; the first sample's rate is that of some tenths of a
/// second before.
void Filter::continue_from(const model::Belief& predecessor, std::int64_t utime, std::optional<double> turn_rate) {
  counters_.add("starts.inherited");
  belief_ = predecessor;
  extrapolate_over_restart(belief_, base::seconds_between(predecessor.utime, utime), turn_rate);
  belief_.utime = utime;
  last_good_ = belief_;
  started_ = true;
  level_.begin(false, utime);
  update_level();
  start_up_.reset();
}

void Filter::start(const base::ImuSample& sample) {
  if (continue_from_predecessor(sample)) return;
  const std::optional<model::Belief> first = start_up_.add(sample);
  if (!first) {
    still_.add(sample);
    return;
  }
  begin(*first, sample.turned);
}

void Filter::start(const base::WheelSample& sample) {
  odometer_.add(sample);
  const std::optional<model::Belief> first = start_up_.add(sample);
  if (continue_from_predecessor(sample)) return;
  if (first) begin(*first, 0.0);
}

void Filter::begin(const model::Belief& first, double imu_turn) {
  counters_.add(name_of(start_up_.kind()));
  belief_ = last_good_ = first;
  belief_.imu_turn = last_good_.imu_turn = imu_turn;
  started_ = true;
  standing_ = start_up_.kind() == detection::StartUp::Kind::kStanding;
  level_.begin(standing_, first.utime);
  start_up_.reset();
}

void Filter::update_level() {
  const Eigen::Matrix3d R = belief_.mean.attitude.toRotationMatrix();
  const Eigen::Matrix3d in_odom =
      R * belief_.covariance.block<3, 3>(model::kAttitude, model::kAttitude) * R.transpose();
  const double sigma = std::sqrt(std::max(in_odom(0, 0), in_odom(1, 1)));
  if (level_.update(sigma, standing_, belief_.utime, config_->start)) counters_.add("level.lost");
}

/// Adapts the belief to gyro axes that have got stuck, or work again.
void Filter::update_stuck_axes() {
  const Pose before = model::base_pose(belief_.mean, geometry_);
  if (!axes_.update(belief_, mechanisation_.wheel_yaw_rate(), standing_, counters_)) return;
  smoother_.corrected(before, model::base_pose(belief_.mean, geometry_));
  if (axes_.declared_stuck()) {  // the gyro has been wrong for long, and wheels and axle were learnt from it
    detection::reset_wheel_scale(belief_, config_->wheels);
    detection::reset_axle(belief_, config_->wheels);
  }
  if (mechanisation_.last_imu()) mechanisation_.set_last_imu(in_body(axes_.previous_sample()));
  mechanisation_.window().reset();
  slip_.set_yaw_rate_unmeasured(axes_.yaw_rate_unmeasured());
  slip_.accept_both();
  watch_.interrupt();
  reset_yaw_rate_comparison();
  cancel_launch();
}

void Filter::restart_clock(std::int64_t utime) {
  counters_.add("reset.clock");
  inflate_over_gap(belief_, base::seconds_between(belief_.utime, utime), config_->start);
  belief_.utime = utime;
  last_wheels_.reset();
  pending_.clear();
  pending_increment_.reset();
  recent_.clear();
  still_.reset();
  odometer_.reset();
  mechanisation_.reset();
  slip_.reset_detector();
  slip_.accept_both();
  watch_.interrupt();
  reset_yaw_rate_comparison();
  wheels_refused_.reset();
  constraint_refused_.reset();
  cancel_launch();
  standing_ = false;
}

void Filter::restore_if_not_finite() {
  if (is_finite(belief_)) {
    last_good_ = belief_;
    return;
  }
  counters_.add("reset.diverged");
  const std::int64_t utime = belief_.utime;
  belief_ = last_good_;
  restart_clock(utime);
}

void Filter::process_pending_wheels(const model::TimedInertial* next) {
  for (; !pending_.empty(); pending_.pop_front()) {
    const base::WheelSample& wheels = pending_.front();
    const WheelStep step = odometer_.add(wheels);
    const bool trusted = !watch_.faulty(0) && !watch_.faulty(1);
    if (odometer_.newest() && trusted)
      mechanisation_.set_wheel_yaw_rate(model::wheel_yaw_rate(belief_.mean, odometer_.newest()->speed, geometry_));
    else if (!trusted)
      mechanisation_.set_wheel_yaw_rate({});
    mechanisation_.advance(belief_, wheels.utime, next, standing_);
    advance_launch(wheels.utime, next);
    correct_with_wheels(step, next == nullptr);
  }
}

void Filter::update_standing(const model::Inertial& imu, double dt) {
  const bool both_slip = slip_.slipping(0, belief_.utime) && slip_.slipping(1, belief_.utime);
  if (!still_.wheels_rest()) {
    standing_motion_.begin();
  } else if (both_slip || watch_.standstill_unreliable()) {
    leave_standing();
  } else if (const auto speed = standing_motion_.add(imu.acceleration, imu.angular_rate - belief_.mean.gyro_bias, dt)) {
    counters_.add("standstills.moved");
    leave_standing();
    set_speed_after_missed_start(belief_, *speed);
    slip_.reject_both(belief_.utime);
    return;
  }
  const bool still = !both_slip && !watch_.standstill_unreliable() &&
                     still_.still(geometry_.R_base_imu.transpose() * belief_.mean.gyro_bias);
  if (still && !standing_) {
    counters_.add("standstills");
    slip_.reset_detector();
    watch_.on_standstill();
    mechanisation_.window().reset();
    cancel_launch();
    standing_ = true;
  } else if (!still && standing_) {
    leave_standing();
    start_launch();
  }
}

void Filter::start_launch() {
  const auto& last = mechanisation_.last_imu();
  const bool known = last && !watch_.faulty(0) && !watch_.faulty(1) && !heading_.lost() && !axes_.any();
  if (!known) return;
  launch_.emplace(*config_, geometry_, belief_, *last);
  launch_->set_noise(noise_);
}

void Filter::advance_launch(std::int64_t utime, const model::TimedInertial* next) {
  if (launch_ && !launch_->advance(utime, next)) launch_.reset();
}

void Filter::cancel_launch() {
  launch_.reset();
  wheels_rejected_ = false;
}

void Filter::leave_standing() {
  if (!standing_) return;
  standing_ = false;
  set_off_from_ = belief_.mean.position;
  mechanisation_.window().reset();
  inflate_after_standstill(belief_, config_->standstill.travel, geometry_.track_width);
}

bool Filter::wheels_missing(std::int64_t utime) const {
  return !last_wheels_ || base::seconds_between(*last_wheels_, utime) > config_->timing.max_wheel_gap;
}

bool Filter::turn_confirmed(const model::Estimate& estimate) const {
  const bool both = !estimate.no_imu && !estimate.no_wheels && !watch_.faulty(0) && !watch_.faulty(1) && !axes_.any();
  return both && !estimate.slipping && turn_.confirmed();
}

void Filter::emit(const model::Inertial& imu, double dt, bool no_imu, std::vector<model::Estimate>& out) {
  const double rate_sigma = no_imu ? config_->noise.coasting_rate : noise_.gyro / std::sqrt(std::max(dt, 1e-3));
  model::Estimate estimate = model::estimate_base(belief_, imu, rate_sigma, geometry_);
  axes_.restore_biases(estimate);
  estimate.level = no_imu || level_.level() || axes_.all_got_stuck();
  estimate.stationary = standing_;
  estimate.slipping = slip_.slipping(0, belief_.utime) || slip_.slipping(1, belief_.utime);
  estimate.no_imu = no_imu;
  estimate.no_wheels = wheels_missing(belief_.utime) || watch_.all_faulty();
  estimate.turn_confirmed = turn_confirmed(estimate);
  recent_.add(estimate.utime, smoother_.uncorrected(estimate.T_odom_base));
  const double since = std::clamp(base::seconds_between(emitted_, estimate.utime), 0.0, config_->timing.max_imu_gap);
  emitted_ = estimate.utime;
  if (!standing_) smoother_.moved(estimate.T_odom_base, since * estimate.velocity.norm(), since);
  smoother_.apply(estimate);
  if (launch_) launch_->inflate_covariance(estimate, belief_);
  if (still_.wheels_rest()) inflate_for_suspected_motion(estimate, standing_motion_.suspected_speed());
  out.push_back(estimate);
}

void Filter::apply(const model::Observation& z) {
  const Pose before = model::base_pose(belief_.mean, geometry_);
  heading_.correct(belief_, z, model::guarded_gain(belief_, z));
  smoother_.corrected(before, model::base_pose(belief_.mean, geometry_));
}

void Filter::reset_motion(double speed_sigma) {
  counters_.add("reset.doubt");
  cancel_launch();
  inflate_motion_covariance(belief_, speed_sigma, config_->start);
}

}  // namespace curbstone::ekf::filter
