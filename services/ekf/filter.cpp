#include "services/ekf/filter.hpp"

#include <cmath>

namespace curbstone {

namespace {

constexpr std::size_t kHistory = 4096;    // poses: 10 s at 400 Hz
constexpr std::size_t kMaxPending = 256;  // wheel samples between two of the IMU
constexpr double kGapStep = 0.03;         // s: a longer step of the IMU has lost samples
constexpr double kGapNoise = 10.0;        // times the noise in such a step

/// Says nothing, and changes nothing.
Observation<1> no_observation() {
  Observation<1> z;
  z.R(0, 0) = 1.0;
  return z;
}

}  // namespace

Filter::Filter(const EkfConfig& config)
    : config_(config),
      geometry_(config.vehicle),
      start_up_(config),
      still_(config.standstill, config.vehicle.wheel_radius, config.timing.max_wheel_gap),
      odometer_(config.wheels, config.vehicle.wheel_radius, config.timing.max_wheel_gap),
      slip_(config.slip),
      history_(kHistory) {}

void Filter::add(const ImuSample& sample, std::vector<Estimate>& out) {
  if (!started_) {
    start(sample);
    if (!started_) return;
  }
  const TimedInertial next{sample.utime,
                           {geometry_.R_base_imu * sample.angular_rate, geometry_.R_base_imu * sample.acceleration}};
  const double gap = seconds_between(belief_.utime, sample.utime);
  if (gap < 0.0 || gap > config_.timing.max_jump) restart_clock(sample.utime);
  const double dt = last_imu_ ? seconds_between(last_imu_->utime, sample.utime) : 0.0;
  if (dt > config_.timing.max_imu_gap) {
    counters_.add("gaps.imu");
    leave_standing();
    still_.reset();
  }
  still_.add(sample);
  serve_pending(&next);
  advance(sample.utime, &next);
  last_imu_ = next;
  update_standing(sample);
  if (wheels_missing(sample.utime)) correct_without_wheels();
  restore_if_not_finite();
  emit(next.imu, dt, false, out);
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
  if (gap < 0.0 || gap > config_.timing.max_jump) {
    restart_clock(sample.utime);
    last_wheels_ = sample.utime;
  }
  pending_.push_back(sample);
  const bool imu_missing = !last_imu_ || seconds_between(last_imu_->utime, sample.utime) > config_.timing.max_imu_gap;
  if (imu_missing) {
    if (standing_) leave_standing();
    serve_pending(nullptr);
    restore_if_not_finite();
    const Inertial steady{
        belief_.mean.gyro_bias + Eigen::Vector3d(0, 0, coasting_yaw_rate_),
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
  switch (start_up_.kind()) {
    case StartUp::Kind::kStanding:
      counters_.add("starts.standing");
      break;
    case StartUp::Kind::kMoving:
      counters_.add("starts.moving");
      break;
    case StartUp::Kind::kImpatient:
      counters_.add("starts.impatient");
      break;
  }
  belief_ = last_good_ = *first;
  started_ = true;
  standing_ = start_up_.kind() == StartUp::Kind::kStanding;
  start_up_.reset();
}

void Filter::restart_clock(std::int64_t utime) {
  counters_.add("reset.clock");
  const auto square = [](double x) { return x * x; };
  const double speed = std::max(1.0, belief_.mean.velocity.norm());
  const double gap = std::min(10.0, std::max(0.0, seconds_between(belief_.utime, utime)));
  ErrorMatrix& P = belief_.covariance;
  P.diagonal().segment<3>(kPosition).array() += square(speed * gap);
  P.diagonal().segment<3>(kVelocity).array() += square(speed);
  P.diagonal().segment<3>(kAttitude).array() += square(config_.start.moving_tilt_sigma);
  if (utime < belief_.utime) history_.clear();
  belief_.utime = utime;
  last_imu_.reset();
  last_wheels_.reset();
  pending_.clear();
  still_.reset();
  odometer_.reset();
  slip_.reset();
  window_.reset();
  standing_ = false;
  slipping_until_ = {INT64_MIN, INT64_MIN};
  wheels_refused_since_.reset();
  constraint_refused_since_.reset();
}

void Filter::restore_if_not_finite() {
  const NavState& x = belief_.mean;
  const bool finite = belief_.covariance.allFinite() && x.position.allFinite() && x.velocity.allFinite() &&
                      x.attitude.coeffs().allFinite() && x.gyro_bias.allFinite() && x.accelerometer_bias.allFinite() &&
                      x.wheel_scale.allFinite();
  if (finite) {
    last_good_ = belief_;
    return;
  }
  counters_.add("reset.diverged");
  const std::int64_t utime = belief_.utime;
  belief_ = last_good_;
  restart_clock(utime);
}

// ---- prediction ----------------------------------------------------------------------------------------------------

void Filter::serve_pending(const TimedInertial* next) {
  for (; !pending_.empty(); pending_.pop_front()) {
    const WheelSample& wheels = pending_.front();
    const WheelStep step = odometer_.add(wheels);
    if (odometer_.newest()) {
      const WheelInterval& newest = *odometer_.newest();
      const Eigen::Vector3d& s = belief_.mean.wheel_scale;
      coasting_yaw_rate_ =
          (newest.speed[1] * (1.0 + s[1]) - newest.speed[0] * (1.0 + s[0])) / (geometry_.track_width * (1.0 + s[2]));
    }
    advance(wheels.utime, next);
    correct_with_wheels(step, next == nullptr);
  }
}

/// To `utime`, by the IMU's samples on both sides if they are near enough, else by the wheels.
void Filter::advance(std::int64_t utime, const TimedInertial* next) {
  if (utime <= belief_.utime) return;
  const double dt = seconds_between(belief_.utime, utime);
  const bool bracketed = next && last_imu_ && next->utime > last_imu_->utime &&
                         seconds_between(last_imu_->utime, next->utime) <= config_.timing.max_imu_gap;
  if (bracketed) {
    const double whole = seconds_between(last_imu_->utime, next->utime);
    const double middle = seconds_between(last_imu_->utime, belief_.utime) + 0.5 * dt;
    const double f = std::clamp(middle / whole, 0.0, 1.0);
    const Inertial mean{(1.0 - f) * last_imu_->imu.angular_rate + f * next->imu.angular_rate,
                        (1.0 - f) * last_imu_->imu.acceleration + f * next->imu.acceleration};
    step(mean, dt);
  } else {
    coast(dt);
  }
  belief_.utime = utime;
}

void Filter::step(const Inertial& imu, double dt) {
  NoiseConfig noise = config_.noise;
  if (dt > kGapStep) {
    noise.gyro *= kGapNoise;
    noise.accelerometer *= kGapNoise;
  }
  const BodyMotion before = body_motion(belief_.mean, imu.angular_rate, geometry_);
  if (standing_)
    predict_standing(belief_, imu, dt, noise);
  else
    predict(belief_, imu, dt, noise);
  const BodyMotion after = body_motion(belief_.mean, imu.angular_rate, geometry_);
  const double gained = after.velocity.x() - before.velocity.x();
  window_.add(dt, {0.5 * (before.velocity + after.velocity), before.angular_rate}, imu.angular_rate,
              inertial_speed_ + 0.5 * gained);
  inertial_speed_ += gained;
}

void Filter::coast(double dt) {
  const Eigen::Vector3d rate(0, 0, coasting_yaw_rate_);
  predict_coasting(belief_, coasting_yaw_rate_, dt, config_.noise);
  const Eigen::Vector3d gyro = belief_.mean.gyro_bias + rate;
  window_.add(dt, body_motion(belief_.mean, gyro, geometry_), gyro, inertial_speed_);
}

void Filter::update_standing(const ImuSample& sample) {
  (void)sample;
  const bool still = still_.still(geometry_.R_base_imu.transpose() * belief_.mean.gyro_bias);
  if (still && !standing_) {
    counters_.add("standstills");
    slip_.reset();
    window_.reset();
    standing_ = true;
  } else if (!still && standing_) {
    leave_standing();
  }
}

/// The vehicle may have moved and turned a little before the wheels' travel was noticed.
void Filter::leave_standing() {
  if (!standing_) return;
  standing_ = false;
  window_.reset();
  const double moved = config_.standstill.travel;
  const double turned = 2.0 * moved / geometry_.track_width;
  const Eigen::Vector3d yaw_axis = belief_.mean.attitude.conjugate() * Eigen::Vector3d::UnitZ();
  belief_.covariance.diagonal().segment<3>(kPosition).array() += moved * moved;
  belief_.covariance.block<3, 3>(kAttitude, kAttitude) += turned * turned * yaw_axis * yaw_axis.transpose();
}

// ---- correction ----------------------------------------------------------------------------------------------------

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
      const bool covered = window_.duration() > 0.5 * interval.duration();
      if (covered && standing_)
        correct_standing();
      else if (covered && coasting)
        correct_coasting(interval);
      else if (covered)
        correct_driving(interval);
      window_.reset();
      return;
    }
  }
  slip_.reset();
  window_.reset();
}

double Filter::wheel_sigma(const WheelInterval& interval, std::size_t wheel) const {
  const WheelsConfig& c = config_.wheels;
  const double speed = std::abs(interval.speed[wheel]);
  const double angle = std::sqrt(2.0) * geometry_.wheel_radius * c.angle_noise / interval.duration();
  const double stamp = std::sqrt(2.0) * speed * c.stamp_noise / interval.duration();
  const double slip = speed * c.slip_noise;
  return std::sqrt(c.speed_noise * c.speed_noise + slip * slip + stamp * stamp + angle * angle);
}

void Filter::correct_driving(const WheelInterval& interval) {
  const BodyMotion motion = window_.motion();
  const auto observe = [&](std::size_t wheel, double sigma) {
    return observe_wheel(belief_.mean, motion, static_cast<Wheel>(wheel), interval.speed[wheel], sigma, geometry_);
  };
  std::array<double, 2> distances = {};
  for (std::size_t wheel = 0; wheel < 2; ++wheel)
    distances[wheel] = distance(belief_, observe(wheel, wheel_sigma(interval, wheel)));
  notice_slip(interval, distances);

  std::array<Observation<1>, 2> rows;
  bool refused = true;
  for (std::size_t wheel = 0; wheel < 2; ++wheel) {
    const bool slipping = interval.end < slipping_until_[wheel];
    rows[wheel] = slipping ? no_observation() : observe(wheel, wheel_sigma(interval, wheel));
    refused = refused && slipping;
  }
  apply(stack(stack(rows[0], rows[1]), observe_constraint(motion)));
  notice_refusal(wheels_refused_since_, refused, interval.mean_speed() - motion.velocity.x());
}

/// One wheel that disagrees with the filter slips; if only the yaw rates disagree, the one that is farther off does.
void Filter::notice_slip(const WheelInterval& interval, const std::array<double, 2>& distances) {
  const Eigen::Vector3d& s = belief_.mean.wheel_scale;
  const double left = interval.speed[0] * (1.0 + s[0]);
  const double right = interval.speed[1] * (1.0 + s[1]);
  const SlipDetector::Signs signs =
      slip_.add({kSecondsPerMicrosecond * static_cast<double>(interval.end), 0.5 * (left + right),
                 (right - left) / (geometry_.track_width * (1.0 + s[2])), window_.motion().angular_rate.z(),
                 window_.inertial_speed()});
  const auto hold = static_cast<std::int64_t>(config_.slip.hold / kSecondsPerMicrosecond);
  for (std::size_t wheel = 0; wheel < 2; ++wheel) {
    const bool gated = distances[wheel] > kGate1;
    const bool worse = distances[wheel] >= distances[1 - wheel];
    if (gated) counters_.add(wheel == 0 ? "gated.wheel_left" : "gated.wheel_right");
    if (!gated && !signs.speeding && !(signs.turning && worse)) continue;
    if (interval.end >= slipping_until_[wheel]) counters_.add(wheel == 0 ? "slips.left" : "slips.right");
    slipping_until_[wheel] = interval.end + hold;
  }
  if (signs.turning) counters_.add("slip_signs.turning");
  if (signs.speeding) counters_.add("slip_signs.speeding");
}

/// Whatever disagrees for seconds on end is more likely right than a filter that integrates alone: it doubts itself.
void Filter::notice_refusal(std::optional<std::int64_t>& since, bool refused, double residual) {
  if (!refused) {
    since.reset();
    return;
  }
  if (!since) since = belief_.utime;
  if (seconds_between(*since, belief_.utime) < config_.slip.patience) return;
  counters_.add("reset.doubt");
  const auto doubt = [&](int index, double sigma) {
    belief_.covariance.diagonal().segment<3>(index).array() += sigma * sigma;
  };
  doubt(kVelocity, residual);
  doubt(kAttitude, config_.start.moving_tilt_sigma);
  doubt(kGyroBias, config_.start.gyro_bias_sigma);
  doubt(kAccelerometerBias, config_.start.accelerometer_bias_sigma);
  forget_wheel_scale(belief_, config_.wheels);
  slipping_until_ = {INT64_MIN, INT64_MIN};
  since.reset();
}

Observation<2> Filter::observe_constraint(const BodyMotion& motion) {
  const WheelsConfig& c = config_.wheels;
  const double lateral_sigma = std::hypot(c.lateral_noise, c.lateral_lever * motion.angular_rate.z());
  Observation<1> lateral = observe_no_motion_along(1, motion, lateral_sigma, geometry_);
  Observation<1> vertical = observe_no_motion_along(2, motion, c.vertical_noise, geometry_);
  const bool lateral_fits = soften_beyond(kGate1, belief_, lateral);
  const bool vertical_fits = soften_beyond(kGate1, belief_, vertical);
  if (!lateral_fits) counters_.add("gated.lateral");
  if (!vertical_fits) counters_.add("gated.vertical");
  notice_refusal(constraint_refused_since_, !lateral_fits || !vertical_fits, motion.velocity.tail<2>().norm());
  return stack(lateral, vertical);
}

void Filter::correct_coasting(const WheelInterval& interval) {
  const BodyMotion motion = window_.motion();
  const double sigma = std::max(wheel_sigma(interval, 0), wheel_sigma(interval, 1));
  Observation<1> forward = observe_forward_speed(belief_.mean, motion, interval.mean_speed(), sigma);
  if (!soften_beyond(kGate1, belief_, forward)) counters_.add("gated.forward");
  Observation<2> constraint = observe_constraint(motion);
  constraint.H.middleCols<3>(kGyroBias).setZero();  // the rate comes from the wheels
  apply(stack(forward, constraint));
}

void Filter::correct_standing() {
  const double rate_density = std::hypot(config_.noise.gyro, config_.standstill.rate_noise);
  Observation<3> velocity = observe_standing_velocity(belief_.mean, config_.standstill.speed_noise);
  Observation<3> rate =
      observe_standing_rate(belief_.mean, window_.gyro(), rate_density / std::sqrt(window_.duration()));
  if (!soften_beyond(kGate3, belief_, velocity)) counters_.add("gated.standing_velocity");
  if (!soften_beyond(kGate3, belief_, rate)) counters_.add("gated.standing_rate");
  apply(stack(velocity, rate));
}

void Filter::correct_without_wheels() {
  if (window_.duration() < config_.wheels.interval) return;
  apply(observe_constraint(window_.motion()));
  window_.reset();
}

// ---- output --------------------------------------------------------------------------------------------------------

bool Filter::wheels_missing(std::int64_t utime) const {
  return !last_wheels_ || seconds_between(*last_wheels_, utime) > config_.timing.max_wheel_gap;
}

void Filter::emit(const Inertial& imu, double dt, bool no_imu, std::vector<Estimate>& out) {
  const double rate_sigma = no_imu ? config_.noise.coasting_rate : config_.noise.gyro / std::sqrt(std::max(dt, 1e-3));
  Estimate estimate = estimate_base(belief_, imu, rate_sigma, geometry_);
  estimate.stationary = standing_;
  estimate.slipping = belief_.utime < std::max(slipping_until_[0], slipping_until_[1]);
  estimate.no_imu = no_imu;
  estimate.no_wheels = wheels_missing(belief_.utime);
  history_.add(estimate.utime, estimate.T_odom_base);
  out.push_back(estimate);
}

}  // namespace curbstone
