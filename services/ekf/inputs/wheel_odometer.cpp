#include "services/ekf/inputs/wheel_odometer.hpp"

#include <algorithm>
#include <cmath>

namespace curbstone::ekf::inputs {

namespace {
constexpr double kStampSlack = 0.02;       // s: a late stamp makes the next difference look short, and the wheel fast
constexpr double kJitters = 40.0;          // minimum interval in sigmas of its stamps: 3.5 % of the speed
constexpr double kMaxAcceleration = 15.0;  // m/s^2, of a wheel on the ground
constexpr double kFits = 4.0;              // sigmas by which two consecutive speeds may differ in addition
constexpr double kMaxInterval = 0.2;       // s, upper bound of that: slip lasts little longer
}  // namespace

double wheel_sigma(const base::WheelsConfig& config, const WheelInterval& interval, double wheel_radius,
                   std::size_t wheel) {
  const double speed = std::abs(interval.speed[wheel]);
  const double angle = std::sqrt(2.0) * wheel_radius * config.angle_noise / interval.duration();
  const double stamp = std::sqrt(2.0) * speed * config.stamp_noise / interval.duration();
  const double jitter = speed * interval.jitter;
  const double slip = speed * config.slip_noise;
  return std::sqrt(config.speed_noise * config.speed_noise + slip * slip + stamp * stamp + angle * angle +
                   jitter * jitter);
}

WheelInterval WheelOdometer::between(const base::WheelSample& a, const base::WheelSample& b) const {
  WheelInterval out{a.utime, b.utime, {}, 0.0};
  out.jitter = std::sqrt(2.0) * jitter_.sigma() / out.duration();
  for (std::size_t i = 0; i < 2; ++i) out.speed[i] = radius_ * (b.angle[i] - a.angle[i]) / out.duration();
  return out;
}

WheelOdometer::Step WheelOdometer::add(const base::WheelSample& sample) {
  const auto begin_again = [&](Step step) {
    begin_ = last_ = sample;
    samples_ = 1;
    newest_.reset();
    jitter_.interrupt();
    jitter_.add(sample);
    return step;
  };
  if (!begin_) return begin_again(Step::kFirst);
  const double dt = base::seconds_between(last_.utime, sample.utime);
  if (dt <= 0.0 || dt > max_gap_) return begin_again(Step::kGap);
  for (std::size_t i = 0; i < 2; ++i) {
    const double travel = radius_ * std::abs(sample.angle[i] - last_.angle[i]);
    if (!(travel <= config_.max_speed * (dt + kStampSlack))) return begin_again(Step::kNonsense);
  }
  jitter_.add(sample);
  if (samples_ < kChecked && ++samples_ == kChecked && !fits_first(sample)) begin_ = last_;
  newest_ = between(last_, sample);
  last_ = sample;
  if (base::seconds_between(begin_->utime, sample.utime) < min_duration()) return Step::kOpen;
  interval_ = between(*begin_, sample);
  begin_ = sample;
  return Step::kInterval;
}

/// Whether the change of speed from the first two to the last two of three samples is possible for a wheel.
bool WheelOdometer::fits_first(const base::WheelSample& third) const {
  const WheelInterval before = *newest_;
  const WheelInterval after = between(last_, third);
  for (std::size_t i = 0; i < 2; ++i) {
    const double sigma = std::hypot(wheel_sigma(config_, before, radius_, i), wheel_sigma(config_, after, radius_, i));
    if (std::abs(after.speed[i] - before.speed[i]) > kMaxAcceleration * after.duration() + kFits * sigma) return false;
  }
  return true;
}

double WheelOdometer::min_duration() const {
  return std::max(config_.interval, std::min(kJitters * jitter_.sigma(), kMaxInterval));
}

void WheelOdometer::reset() {
  begin_.reset();
  newest_.reset();
  jitter_.interrupt();
}

}  // namespace curbstone::ekf::inputs
