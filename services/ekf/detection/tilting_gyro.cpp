#include "services/ekf/detection/tilting_gyro.hpp"

#include <algorithm>
#include <cmath>

#include "common/geometry/geometry.hpp"
#include "common/geometry/gravity.hpp"

namespace curbstone::ekf::detection {

namespace {

constexpr std::size_t kMean = 6;   // intervals at each end, over which gravity is averaged
constexpr double kUneven = 0.35;   // of the leap: the rate's halves differ by less
constexpr double kByGyro = 0.6;    // of the leap, that the gyro itself shows at least
constexpr double kMaxAngle = 1.0;  // rad: beyond it the gyro is wrong otherwise
constexpr double kSigmas = 5.0;    // of the IMU's noise

/// rad, what the IMU's noise does not add up to in this time.
double least_angle(double seconds, std::size_t intervals, const base::NoiseConfig& noise) {
  const double by_rate = noise.gyro * std::sqrt(seconds);
  const double by_force = noise.accelerometer / kGravity / std::sqrt(seconds * kMean / static_cast<double>(intervals));
  return std::max(TiltingGyro::kMinAngle, kSigmas * std::hypot(by_rate, by_force, by_force));
}

}  // namespace

std::optional<TiltingGyro::Leap> TiltingGyro::add(const Interval& interval, const model::NavState& state,
                                                  const base::NoiseConfig& noise) {
  Eigen::Vector3d up = interval.force;
  if (!seen_.empty()) {
    const Interval& last = seen_.back().interval;
    const double faster = interval.velocity.x() - last.velocity.x();
    up.x() -= faster / (0.5 * (last.seconds + interval.seconds));
    up.y() -= interval.rate.z() * interval.velocity.x();
  }
  seen_.push_back({interval, up, state});
  if (seen_.size() > kWindows.back() + kMean + kLasts) seen_.pop_front();
  for (std::size_t i = 0; i < kWindows.size(); ++i) {
    const std::optional<Excess> excess = excess_within(kWindows[i], noise);
    Suspicion& suspicion = suspected_[i];
    const bool goes_on = excess && (suspicion.lasts == 0 || excess->rate.dot(suspicion.rate) > 0.0);
    suspicion.lasts = goes_on ? suspicion.lasts + 1 : 0;
    if (!goes_on) continue;
    suspicion.rate = excess->rate;
    if (suspicion.lasts < kLasts) continue;
    const std::size_t length = kWindows[i] + kMean + static_cast<std::size_t>(kLasts);
    const Leap leap = leap_since(seen_.size() - std::min(length, seen_.size()), *excess);
    interrupt();
    return leap;
  }
  return {};
}

/// The direction of gravity over kMean intervals, with the accelerometer's and the gyro's biases of `state`.
Eigen::Vector3d TiltingGyro::mean_up(std::size_t begin, const model::NavState& state) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = begin; i < begin + kMean; ++i) {
    const double aside = state.gyro_bias.z() * seen_[i].interval.velocity.x();
    sum += Eigen::Vector3d(seen_[i].up - state.accelerometer_bias + aside * Eigen::Vector3d::UnitY());
  }
  return sum.normalized();
}

TiltingGyro::GyroTurn TiltingGyro::turn_by_gyro(std::size_t begin, std::size_t intervals, const Eigen::Vector3d& bias,
                                                const Eigen::Vector3d& up) const {
  GyroTurn sum;
  sum.up = up;
  for (std::size_t i = 0; i < intervals; ++i) {
    const Interval& interval = seen_[begin + i].interval;
    const Eigen::Vector3d turn = interval.seconds * (interval.rate - bias);
    sum.up = so3_exp(turn).conjugate() * sum.up;
    sum.seconds += interval.seconds;
    const std::size_t half = 2 * i < intervals ? 0 : 1;
    sum.halves[half] += turn.head<2>();
    sum.half_seconds[half] += interval.seconds;
  }
  return sum;
}

/// From the middle of kMean intervals to that of the last kMean, `intervals` later.
std::optional<TiltingGyro::Excess> TiltingGyro::excess_within(std::size_t intervals,
                                                              const base::NoiseConfig& noise) const {
  if (seen_.size() < intervals + kMean) return {};
  const std::size_t begin = seen_.size() - intervals - kMean;
  const model::NavState& before = seen_[begin].state;  // biases that are learnt during a leap are wrong
  const Eigen::Vector3d first = mean_up(begin, before);
  const Eigen::Vector3d last = mean_up(begin + intervals, before);
  const GyroTurn turn = turn_by_gyro(begin + kMean / 2, intervals, before.gyro_bias, first);
  const Eigen::Vector2d excess = turn.up.cross(last).head<2>();  // rad, by which the gyro has turned too far
  const double angle = excess.norm();
  if (angle < least_angle(turn.seconds, intervals, noise) || angle > kMaxAngle) return {};
  const double shown = (turn.halves[0] + turn.halves[1]).dot(excess) / angle;
  const double uneven = (turn.halves[0] / turn.half_seconds[0] - turn.halves[1] / turn.half_seconds[1]).norm();
  if (shown < kByGyro * angle || uneven > kUneven * angle / turn.seconds) return {};
  const Eigen::Vector2d rate = excess / angle * std::asin(angle) / turn.seconds;
  return Excess{rate, before.gyro_bias + Eigen::Vector3d(rate.x(), rate.y(), 0.0), last};
}

TiltingGyro::Leap TiltingGyro::leap_since(std::size_t begin, const Excess& excess) const {
  Leap leap;
  model::NavState& state = leap.state = seen_[begin].state;
  leap.rate = (excess.bias - state.gyro_bias).head<2>();
  state.gyro_bias.head<2>() = excess.bias.head<2>();
  for (std::size_t i = begin + 1; i < seen_.size(); ++i) {
    const Interval& interval = seen_[i].interval;
    const Eigen::Vector3d turn = interval.seconds * (interval.rate - state.gyro_bias);
    state.position += interval.seconds * (state.attitude * (so3_exp(0.5 * turn) * interval.velocity));
    state.attitude = (state.attitude * so3_exp(turn)).normalized();
    leap.seconds += interval.seconds;
    leap.way += interval.seconds * interval.velocity.norm();
  }
  state.velocity = seen_.back().interval.velocity;
  const Eigen::Vector3d up = state.attitude.conjugate() * Eigen::Vector3d::UnitZ();
  state.attitude = (state.attitude * Eigen::Quaterniond::FromTwoVectors(excess.up, up)).normalized();
  return leap;
}

}  // namespace curbstone::ekf::detection
