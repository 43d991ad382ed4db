#include "services/ekf/mounting/setting_off.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "common/geometry/geometry.hpp"

namespace curbstone::ekf::mounting {

namespace {

constexpr double kStill = 0.004;      // m of a wheel's travel
constexpr double kUnnoticed = 0.5;    // s for which it may have moved before the wheels' travel shows it
constexpr double kMaxGap = 0.1;       // s between samples of the IMU
constexpr double kMaxWheelGap = 0.5;  // s, likewise
constexpr double kOtherTurn = 0.2;    // rad by which the wheels may turn otherwise than the gyro
constexpr double kMinWayRatio = 0.6, kMaxWayRatio = 1.6;  // way of the IMU as a multiple of the wheels'

}  // namespace

SettingOff::SettingOff(const VehicleConfig& vehicle)
    : R_base_imu_(vehicle.T_base_imu().linear()),
      lever_(vehicle.T_base_imu().translation().head<2>()),
      radius_(vehicle.wheel_radius),
      track_(vehicle.track_width) {}

void SettingOff::add(const base::ImuSample& sample) {
  const Inertial inertial{sample.utime, R_base_imu_ * sample.angular_rate, R_base_imu_ * sample.acceleration};
  if (sets_off_) return integrate(inertial);
  const double dt = at_rest_.empty() ? 0.0 : base::seconds_between(at_rest_.back().utime, sample.utime);
  if (dt < 0.0 || dt > kMaxGap) at_rest_.clear();
  at_rest_.push_back(inertial);
  while (base::seconds_between(at_rest_.front().utime, sample.utime) > 2.0 * kRest + kUnnoticed) at_rest_.pop_front();
}

/// m, the farther of both wheels.
double SettingOff::travel_since(const base::WheelSample& begin, const base::WheelSample& sample) const {
  return radius_ * std::max(std::abs(sample.angle[0] - begin.angle[0]), std::abs(sample.angle[1] - begin.angle[1]));
}

std::optional<SettingOff::Start> SettingOff::add(const base::WheelSample& sample) {
  const double dt = latest_ ? base::seconds_between(latest_->utime, sample.utime) : 0.0;
  latest_ = sample;
  if (dt < 0.0 || dt > kMaxWheelGap || !still_since_) {
    roll(sample);
    return {};
  }
  if (sets_off_) return judge(sample);
  if (travel_since(*still_since_, sample) > kStill) begin(sample);
  return {};
}

void SettingOff::roll(const base::WheelSample& sample) {
  sets_off_ = false;
  still_since_ = sample;
  at_rest_.clear();
}

void SettingOff::begin(const base::WheelSample& sample) {
  const std::deque<Inertial> samples = std::exchange(at_rest_, {});
  const auto moves = std::find_if(samples.begin(), samples.end(), [&](const Inertial& s) {
    return base::seconds_between(s.utime, sample.utime) < kUnnoticed;
  });
  if (moves == samples.begin() || base::seconds_between(samples.front().utime, std::prev(moves)->utime) < kRest)
    return roll(sample);
  const auto count = static_cast<double>(moves - samples.begin());
  rest_rate_ = rest_force_ = Eigen::Vector3d::Zero();
  for (auto s = samples.begin(); s != moves; ++s) {
    rest_rate_ += s->rate / count;
    rest_force_ += s->force / count;
  }
  sets_off_ = true;
  began_ = sample.utime;
  last_ = std::prev(moves)->utime;
  last_force_ = std::prev(moves)->force;
  R_rest_body_.setIdentity();
  velocity_.setZero();
  way_ = 0.0;
  turn_ = changes_ = seconds_ = 0.0;
  samples_ = 0;
  first_.reset();
  std::for_each(moves, samples.end(), [this](const Inertial& s) { integrate(s); });
}

void SettingOff::integrate(const Inertial& sample) {
  const double dt = base::seconds_between(last_, sample.utime);
  last_ = sample.utime;
  if (dt < 0.0 || dt > kMaxGap) roll(*latest_);
  if (!sets_off_) return;
  const Eigen::Vector3d rate = sample.rate - rest_rate_;
  R_rest_body_ = (R_rest_body_ * so3_exp(rate * dt)).normalized();
  velocity_ += (R_rest_body_ * sample.force - rest_force_) * dt;
  const Eigen::Vector3d in_body = R_rest_body_.conjugate() * velocity_;
  way_ += std::complex<double>(in_body.x(), in_body.y()) * dt;
  turn_ += rate.z() * dt;
  changes_ += (sample.force - last_force_).head<2>().squaredNorm();
  last_force_ = sample.force;
  seconds_ += dt;
  ++samples_;
}

std::optional<SettingOff::Start> SettingOff::judge(const base::WheelSample& sample) {
  const double left = radius_ * (sample.angle[0] - still_since_->angle[0]);
  const double right = radius_ * (sample.angle[1] - still_since_->angle[1]);
  const double travel = 0.5 * std::abs(left + right);
  const bool one_spins = std::max(std::abs(left), std::abs(right)) > 4.0 * kTravel;
  if (one_spins || base::seconds_between(began_, sample.utime) > kMaxDuration) {
    roll(sample);
  } else if (travel >= kTravel && !first_) {
    first_ = measured(left, right);
    if (!first_) roll(sample);
  } else if (travel >= 2.0 * kTravel) {
    const std::optional<double> second = measured(left, right);
    roll(sample);
    const bool agree = second && std::abs(std::remainder(*second - *first_, 2.0 * std::numbers::pi)) < kUneven;
    if (agree) return Start{*second, left + right > 0.0};
  }
  return {};
}

/// m, 1 sigma: white noise that is integrated twice.
double SettingOff::noise_of_way() const {
  const double variance = changes_ / (4.0 * samples_);  // of a sample, of one axis
  return std::sqrt(variance / (3.0 * samples_)) * seconds_ * seconds_;
}

/// The angle from the IMU's way to the wheels' (m, of each wheel).
std::optional<double> SettingOff::measured(double left, double right) const {
  const std::complex<double> expected(0.5 * (left + right) - turn_ * lever_.y(), turn_ * lever_.x());
  if (noise_of_way() > kMaxSigma * std::abs(expected)) return {};
  const double gain = std::abs(way_) / std::abs(expected);
  if (std::abs((right - left) / track_ - turn_) > kOtherTurn || !(gain > kMinWayRatio && gain < kMaxWayRatio))
    return {};
  return std::arg(expected / way_);
}

}  // namespace curbstone::ekf::mounting
