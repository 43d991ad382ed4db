#include "tools/simulate/motion/speed_profile.hpp"

#include <algorithm>
#include <numbers>

namespace curbstone::simulate::motion {

namespace {

constexpr double kBackSpeed = 1.0;  // m/s
constexpr double kBackDrive = 8.0;  // s from setting off backwards to braking
constexpr double kTurnRate = 0.5;   // rad/s, the mean; the peak is 15/8 of it

}  // namespace

SpeedProfile::SpeedProfile(const Options& options, double seconds) : cruise_(options.speed) {
  const double ramp = std::max(0.5, 1.5 * options.speed / options.acceleration);  // the ramp's peak is 1.5 of its mean
  ramps_.push_back({-1e9, 1.0, 0.0, 0.0, 0.0});
  double t = options.standstill, distance = 0;
  for (int legs = 1; t < seconds + 60.0 && end_ > t; ++legs) {
    ramps_.push_back({t, ramp, 0.0, options.speed, distance});
    // During both ramps the speed is half on average, so a leg covers the distance at full speed over its duration
    // without the final ramp.
    const double rest = (options.distance - distance) / options.speed;
    const double leg = std::max(ramp, options.drive);  // it brakes only after it has reached its speed
    const bool last = rest < leg + 2.0 * ramp;         // one longer leg, rather than a last one that is too short
    const double drive = last ? std::max(ramp, rest) : leg;
    distance += options.speed * (drive - 0.5 * ramp);
    t += drive;
    ramps_.push_back({t, ramp, options.speed, 0.0, distance});
    distance += options.speed * 0.5 * ramp;
    if (last) end_ = t + ramp;
    t += ramp + options.stop;
    if (options.manoeuvres && !last) {
      if (legs % 4 == 1) back_up(t, distance, options);
      if (legs % 4 == 2) turn(t, 2.0 * std::numbers::pi, options);
      if (legs % 4 == 3) turn(t, std::numbers::pi, options);
      if (legs % 4 == 0) turn(t, -std::numbers::pi, options);
    }
  }
}

void SpeedProfile::back_up(double& t, double& distance, const Options& options) {
  const double ramp = std::max(0.5, 1.5 * kBackSpeed / options.acceleration);
  ramps_.push_back({t, ramp, 0.0, -kBackSpeed, distance});
  distance -= kBackSpeed * (kBackDrive - 0.5 * ramp);
  ramps_.push_back({t + kBackDrive, ramp, -kBackSpeed, 0.0, distance});
  distance -= kBackSpeed * 0.5 * ramp;
  t += kBackDrive + ramp + options.stop;
}

void SpeedProfile::turn(double& t, double angle, const Options& options) {
  turns_.push_back({t, std::abs(angle) / kTurnRate, angle});
  t += turns_.back().duration + options.stop;
}

const SpeedProfile::Ramp& SpeedProfile::ramp_at(double t) const {
  const auto after =
      std::upper_bound(ramps_.begin(), ramps_.end(), t, [](double v, const Ramp& r) { return v < r.start; });
  return after == ramps_.begin() ? ramps_.front() : *(after - 1);
}

double SpeedProfile::distance(double t) const {
  const Ramp& r = ramp_at(t);
  const double f = std::clamp((t - r.start) / r.duration, 0.0, 1.0);
  const double eased = f * f * f * (1.0 - 0.5 * f);  // integral of 3 f^2 - 2 f^3
  const double beyond = std::max(0.0, t - r.start - r.duration);
  return r.distance + r.duration * (r.v0 * f + (r.v1 - r.v0) * eased) + r.v1 * beyond;
}

double SpeedProfile::speed(double t) const {
  const Ramp& r = ramp_at(t);
  const double f = std::clamp((t - r.start) / r.duration, 0.0, 1.0);
  return r.v0 + (r.v1 - r.v0) * f * f * (3.0 - 2.0 * f);
}

double SpeedProfile::acceleration(double t) const {
  const Ramp& r = ramp_at(t);
  const double f = std::clamp((t - r.start) / r.duration, 0.0, 1.0);
  return (r.v1 - r.v0) * 6.0 * f * (1.0 - f) / r.duration;
}

double SpeedProfile::turned(double t) const {
  double angle = 0;
  for (const Turn& turn : turns_) {
    const double f = std::clamp((t - turn.start) / turn.duration, 0.0, 1.0);
    angle += turn.angle * f * f * f * (10.0 + f * (6.0 * f - 15.0));  // begins and ends without angular acceleration
  }
  return angle;
}

}  // namespace curbstone::simulate::motion
