#include "services/ekf/filter.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace curbstone {

namespace {

constexpr std::size_t kRecent = 1024;     // poses: 2.5 s at 400 Hz
constexpr double kMaxAxleError = 4.0;     // sigma: farther from its configured place it was learnt from nonsense
constexpr std::size_t kMaxPending = 256;  // wheel samples between two of the IMU

double square(double x) {
  return x * x;
}

/// Says nothing, and changes nothing.
Observation no_observation() {
  Observation z(1);
  z.R(0, 0) = 1.0;
  return z;
}

const char* name_of(StartUp::Kind kind) {
  switch (kind) {
    case StartUp::Kind::kStanding:
      return "starts.standing";
    case StartUp::Kind::kMoving:
      return "starts.moving";
    default:
      return "starts.impatient";
  }
}

}  // namespace

Filter::Filter(const EkfConfig& config)
    : config_(std::make_shared<const EkfConfig>(config)),
      geometry_(config.vehicle),
      start_up_(config),
      still_(config.standstill, config.vehicle.wheel_radius, config.timing.max_wheel_gap),
      odometer_(config.wheels, config.vehicle.wheel_radius, config.timing.max_wheel_gap),
      mechanisation_(config, geometry_),
      slip_(config.slip, geometry_),
      spreader_(config.spread),
      recent_(kRecent) {}

void Filter::add(const ImuSample& sample, std::vector<Estimate>& out) {
  if (!started_) {
    start(sample);
    if (!started_) return;
  }
  const TimedInertial next{sample.utime,
                           {geometry_.R_base_imu * sample.angular_rate, geometry_.R_base_imu * sample.acceleration}};
  const double gap = seconds_between(belief_.utime, sample.utime);
  if (gap < 0.0 || gap > config_->timing.max_jump) restart_clock(sample.utime);
  const auto& last = mechanisation_.last_imu();
  const double dt = last ? seconds_between(last->utime, sample.utime) : 0.0;
  if (dt > config_->timing.max_imu_gap) {
    counters_.add("gaps.imu");
    leave_standing();
    still_.reset();
  }
  still_.add(sample);
  serve_pending(&next);
  mechanisation_.advance(belief_, sample.utime, &next, standing_);
  mechanisation_.set_last_imu(next);
  update_standing();
  if (wheels_missing(sample.utime)) correct_without_wheels();
  restore_if_not_finite();
  emit(next.imu, dt, false, out);
  if (pending_increment_ && pending_increment_->utime <= sample.utime) correct_with_map();
}

void Filter::add(const WheelSample& sample, std::vector<Estimate>& out) {
  last_wheels_ = sample.utime;
  still_.add(sample);
  if (!started_) {
    start_up_.add(sample);
    odometer_.add(sample);
    return;
  }
  const double gap = seconds_between(belief_.utime, sample.utime);
  if (gap < 0.0 || gap > config_->timing.max_jump) {
    restart_clock(sample.utime);
    last_wheels_ = sample.utime;
  }
  pending_.push_back(sample);
  if (!mechanisation_.imu_at_hand(sample.utime)) {
    if (standing_) leave_standing();
    serve_pending(nullptr);
    restore_if_not_finite();
    const Inertial steady{
        belief_.mean.gyro_bias + Eigen::Vector3d(0, 0, mechanisation_.wheel_yaw_rate()),
        belief_.mean.accelerometer_bias + belief_.mean.attitude.conjugate() * Eigen::Vector3d(0, 0, kGravity)};
    emit(steady, 0.0, true, out);
  } else if (pending_.size() > kMaxPending) {
    counters_.add("dropped.pending");
    pending_.pop_front();
  }
}

void Filter::start(const ImuSample& sample) {
  const std::optional<Belief> first = start_up_.add(sample);
  if (!first) {
    still_.add(sample);
    return;
  }
  counters_.add(name_of(start_up_.kind()));
  belief_ = last_good_ = *first;
  started_ = true;
  standing_ = start_up_.kind() == StartUp::Kind::kStanding;
  start_up_.reset();
}

void Filter::restart_clock(std::int64_t utime) {
  counters_.add("reset.clock");
  const double speed = std::max(1.0, belief_.mean.velocity.norm());
  const double gap = std::clamp(seconds_between(belief_.utime, utime), 0.0, 10.0);
  ErrorMatrix& P = belief_.covariance;
  P.diagonal().segment<3>(kPosition).array() += square(speed * gap);
  P.diagonal().segment<3>(kVelocity).array() += square(speed);
  P.diagonal().segment<3>(kAttitude).array() += square(config_->start.moving_tilt_sigma);
  belief_.utime = utime;
  last_wheels_.reset();
  pending_.clear();
  pending_increment_.reset();
  recent_.clear();
  still_.reset();
  odometer_.reset();
  mechanisation_.reset();
  slip_.reset_detector();
  slip_.acquit();
  wheels_refused_.reset();
  constraint_refused_.reset();
  standing_ = false;
}

void Filter::restore_if_not_finite() {
  const NavState& x = belief_.mean;
  const bool finite = belief_.covariance.allFinite() && x.position.allFinite() && x.velocity.allFinite() &&
                      x.attitude.coeffs().allFinite() && x.gyro_bias.allFinite() && x.accelerometer_bias.allFinite() &&
                      x.wheel_scale.allFinite() && std::isfinite(x.axle) && x.course.allFinite();
  if (finite) {
    last_good_ = belief_;
    return;
  }
  counters_.add("reset.diverged");
  const std::int64_t utime = belief_.utime;
  belief_ = last_good_;
  restart_clock(utime);
}

void Filter::serve_pending(const TimedInertial* next) {
  for (; !pending_.empty(); pending_.pop_front()) {
    const WheelSample& wheels = pending_.front();
    const WheelStep step = odometer_.add(wheels);
    if (odometer_.newest())
      mechanisation_.set_wheel_yaw_rate(wheel_yaw_rate(belief_.mean, odometer_.newest()->speed, geometry_));
    mechanisation_.advance(belief_, wheels.utime, next, standing_);
    correct_with_wheels(step, next == nullptr);
  }
}

void Filter::update_standing() {
  const bool still = still_.still(geometry_.R_base_imu.transpose() * belief_.mean.gyro_bias);
  if (still && !standing_) {
    counters_.add("standstills");
    slip_.reset_detector();
    mechanisation_.window().reset();
    standing_ = true;
  } else if (!still && standing_) {
    leave_standing();
  }
}

/// The vehicle may have moved and turned a little before the wheels' travel was noticed: each wheel by anything up to
/// it, evenly distributed.
void Filter::leave_standing() {
  if (!standing_) return;
  standing_ = false;
  mechanisation_.window().reset();
  const double moved = config_->standstill.travel / std::sqrt(3.0);
  const double turned = config_->standstill.travel / std::sqrt(6.0) / geometry_.track_width;
  const Eigen::Vector3d yaw_axis = belief_.mean.attitude.conjugate() * Eigen::Vector3d::UnitZ();
  belief_.covariance.diagonal().segment<3>(kPosition).array() += square(moved);
  belief_.covariance.block<3, 3>(kAttitude, kAttitude) += square(turned) * yaw_axis * yaw_axis.transpose();
}

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
      const WheelInterval& interval = odometer_.interval();
      const bool covered = mechanisation_.window().duration() > 0.5 * interval.duration();
      if (covered && standing_)
        correct_standing();
      else if (covered && coasting)
        correct_coasting(interval);
      else if (covered)
        correct_driving(interval);
      mechanisation_.window().reset();
      return;
    }
  }
  slip_.reset_detector();
  mechanisation_.window().reset();
}

void Filter::correct_driving(const WheelInterval& interval) {
  const BodyMotion motion = mechanisation_.window().motion();
  const auto observe = [&](std::size_t wheel) {
    return observe_wheel(belief_.mean, motion, static_cast<Wheel>(wheel), interval.speed[wheel],
                         wheel_sigma(config_->wheels, interval, geometry_.wheel_radius, wheel), geometry_);
  };
  std::array<Observation, 2> rows{observe(0), observe(1)};
  slip_.judge(interval, {distance(belief_, rows[0]), distance(belief_, rows[1])}, belief_.mean, mechanisation_.window(),
              counters_);
  bool refused = true;
  for (std::size_t wheel = 0; wheel < 2; ++wheel) {
    const bool slipping = slip_.slipping(wheel, interval.end);
    refused = refused && slipping;
    if (slipping)
      rows[wheel] = no_observation();
    else if (!soften_beyond(kGate1, belief_, rows[wheel]))
      counters_.add(wheel == 0 ? "gated.wheel_left" : "gated.wheel_right");
  }
  apply(stack(stack(rows[0], rows[1]), observe_constraint(motion)));
  const bool strayed =
      std::abs(belief_.mean.axle - config_->wheels.axle) > kMaxAxleError * config_->wheels.axle_sigma ||
      belief_.mean.course.cwiseAbs().maxCoeff() > kMaxAxleError * config_->wheels.course_sigma;
  if (strayed) {
    counters_.add("reset.axle");
    forget_axle(belief_, config_->wheels);
  }
  const bool absurd = motion.velocity.norm() > config_->wheels.max_speed;
  if (wheels_refused_.lasts(refused, belief_.utime, config_->slip.patience) || absurd) {
    doubt(interval.mean_speed() - motion.velocity.x());
    forget_wheel_scale(belief_, config_->wheels);
    slip_.acquit();
  }
}

Observation Filter::observe_constraint(const BodyMotion& motion) {
  const WheelsConfig& c = config_->wheels;
  Observation lateral = observe_no_motion_along(1, belief_.mean, motion, c.lateral_noise, geometry_);
  Observation vertical = observe_no_motion_along(2, belief_.mean, motion, c.vertical_noise, geometry_);
  const bool lateral_fits = soften_beyond(kGate1, belief_, lateral);
  const bool vertical_fits = soften_beyond(kGate1, belief_, vertical);
  if (!lateral_fits) counters_.add("gated.lateral");
  if (!vertical_fits) counters_.add("gated.vertical");
  const bool refused = !lateral_fits || !vertical_fits;
  if (constraint_refused_.lasts(refused, belief_.utime, config_->slip.patience)) {
    doubt(motion.velocity.tail<2>().norm());
    forget_axle(belief_, c);
  }
  return stack(lateral, vertical);
}

/// Speed and tilt have gone astray, and the accelerometer's bias was learnt from them. The gyro's has not: it takes no
/// part in the speed.
void Filter::doubt(double speed_sigma) {
  counters_.add("reset.doubt");
  const auto widen = [&](int index, double sigma) {
    belief_.covariance.diagonal().segment<3>(index).array() += square(sigma);
  };
  widen(kVelocity, speed_sigma);
  widen(kAttitude, config_->start.moving_tilt_sigma);
  forget_accelerometer_bias(belief_, config_->start);
}

void Filter::correct_coasting(const WheelInterval& interval) {
  const BodyMotion motion = mechanisation_.window().motion();
  const auto sigma = [&](std::size_t wheel) {
    return wheel_sigma(config_->wheels, interval, geometry_.wheel_radius, wheel);
  };
  Observation forward =
      observe_forward_speed(belief_.mean, motion, interval.mean_speed(), std::max(sigma(0), sigma(1)));
  if (!soften_beyond(kGate1, belief_, forward)) counters_.add("gated.forward");
  Observation constraint = observe_constraint(motion);
  constraint.H.middleCols<3>(kGyroBias).setZero();  // the rate comes from the wheels
  apply(stack(forward, constraint));
}

void Filter::correct_standing() {
  const MotionWindow& window = mechanisation_.window();
  const double rate_density = std::hypot(config_->noise.gyro, config_->standstill.rate_noise);
  Observation velocity = observe_standing_velocity(belief_.mean, config_->standstill.speed_noise);
  Observation rate = observe_standing_rate(belief_.mean, window.gyro(), rate_density / std::sqrt(window.duration()));
  if (!soften_beyond(kGate3, belief_, velocity)) counters_.add("gated.standing_velocity");
  if (!soften_beyond(kGate3, belief_, rate)) counters_.add("gated.standing_rate");
  apply(stack(velocity, rate));
}

void Filter::correct_without_wheels() {
  MotionWindow& window = mechanisation_.window();
  if (window.duration() < config_->wheels.interval) return;
  apply(observe_constraint(window.motion()));
  window.reset();
}

void Filter::correct_with_map() {
  const MapIncrement increment = *std::exchange(pending_increment_, std::nullopt);
  const auto begin = recent_.at(increment.begin);
  const auto end = recent_.at(increment.utime);
  if (standing_ || !begin || !end) return;
  const Pose believed = begin->inverse() * *end;
  const double dt = seconds_between(increment.begin, increment.utime);
  const BodyMotion mean{believed.translation() / dt, so3_log(Eigen::Quaterniond(believed.linear())) / dt};
  Observation z = observe_increment(increment.T_begin_end, increment.covariance, believed, dt, mean, geometry_);
  counters_.add(soften_beyond(kGate6, belief_, z) ? "map.used" : "gated.map");
  apply(z);
}

void Filter::apply(const Observation& z) {
  const Pose before = base_pose(belief_.mean, geometry_);
  correct(belief_, z, guarded_gain(belief_, z));
  spreader_.corrected(before, base_pose(belief_.mean, geometry_));
}

bool Filter::wheels_missing(std::int64_t utime) const {
  return !last_wheels_ || seconds_between(*last_wheels_, utime) > config_->timing.max_wheel_gap;
}

void Filter::emit(const Inertial& imu, double dt, bool no_imu, std::vector<Estimate>& out) {
  const double rate_sigma = no_imu ? config_->noise.coasting_rate : config_->noise.gyro / std::sqrt(std::max(dt, 1e-3));
  Estimate estimate = estimate_base(belief_, imu, rate_sigma, geometry_);
  estimate.stationary = standing_;
  estimate.slipping = slip_.slipping(0, belief_.utime) || slip_.slipping(1, belief_.utime);
  estimate.no_imu = no_imu;
  estimate.no_wheels = wheels_missing(belief_.utime);
  recent_.add(estimate.utime, spreader_.uncorrected(estimate.T_odom_base));
  const double since = std::clamp(seconds_between(emitted_, estimate.utime), 0.0, config_->timing.max_imu_gap);
  emitted_ = estimate.utime;
  if (!standing_) spreader_.moved(estimate.T_odom_base, since * estimate.velocity.norm(), since);
  spreader_.apply(estimate);
  out.push_back(estimate);
}

}  // namespace curbstone
