#include "services/ekf/filter/launch.hpp"

#include <algorithm>
#include <cmath>

namespace curbstone::ekf::filter {

namespace {

constexpr double kWrong = 0.25;  // share of the speed: a wrong radius causes less
constexpr double kSure = 4.0;    // sigma, in addition to it
constexpr int kIntervals = 3;    // consecutive ones in which the wheels disagree
constexpr double kNearly = 0.1;  // share of the speed within which they agree
constexpr double kLikely = 2.0;  // sigma, in addition to it
constexpr double kJolt = 0.25;   // m/s, leap of the IMU's speed within two intervals: no vehicle drives off like that
constexpr double kOwn = 0.05;    // m/s, by which the wheels' change is smaller in such a leap
constexpr double kAtOnce = 0.6;  // share of the present difference that, within two intervals, is a leap

/// Compares one measurement of the wheels with the belief, for both kinds of limit.
struct Comparison {
  double off = 0.0;    // m/s, difference between wheels and belief
  double speed = 0.0;  // m/s, of the belief
  double sigma = 0.0;  // m/s, 1 sigma of the difference
  [[nodiscard]] bool beyond(double share, double sigmas) const { return off > share * speed + sigmas * sigma; }
};

Comparison comparison(const model::Belief& belief, const model::Observation& z, double measured) {
  const double off = std::abs(z.residual[0]);
  return {off, std::abs(measured - z.residual[0]),
          off / std::sqrt(std::max(model::squared_mahalanobis(belief, z), 1e-12))};
}

/// Whether the speed of the middle, which does not depend on the track width, and those of both wheels are all beyond.
bool all_beyond(double share, double sigmas, const model::Belief& belief, const model::BodyMotion& motion,
                const inputs::WheelInterval& interval, const std::array<double, 2>& sigma,
                const model::Geometry& geometry) {
  const double middle = interval.mean_speed();
  const auto z = model::observe_forward_speed(belief.mean, motion, middle, std::max(sigma[0], sigma[1]));
  if (!comparison(belief, z, middle).beyond(share, sigmas)) return false;
  for (std::size_t i = 0; i < 2; ++i) {
    const double speed = interval.speed[i];
    const auto of_wheel =
        model::observe_wheel(belief.mean, motion, static_cast<model::Wheel>(i), speed, sigma[i], geometry);
    if (!comparison(belief, of_wheel, speed).beyond(share, sigmas)) return false;
  }
  return true;
}

}  // namespace

Launch::Launch(const base::EkfConfig& config, const model::Geometry& geometry, const model::Belief& belief,
               const model::TimedInertial& last)
    : geometry_(geometry), belief_(belief), mechanisation_(config, geometry), begin_(belief.utime) {
  mechanisation_.set_last_imu(last);
}

bool Launch::advance(std::int64_t utime, const model::TimedInertial* next) {
  if (next == nullptr || !mechanisation_.imu_at_hand(next->utime)) return false;
  if (jolted_ || base::seconds_between(begin_, utime) > kMaxDuration) return false;
  mechanisation_.advance(belief_, utime, next, false);
  return true;
}

void Launch::note_leap(const Speeds& now) {
  std::rotate(recent_.begin(), recent_.begin() + 1, recent_.end());
  recent_.back() = now;
  const double of_wheels = now.wheels - recent_.front().wheels;
  const double of_imu = now.imu - recent_.front().imu;
  const double leap = std::abs(of_imu - of_wheels);
  largest_leap_ = std::max(largest_leap_, leap);
  jolted_ = jolted_ || (leap > kJolt && std::abs(of_imu) > std::abs(of_wheels) + kOwn);
}

bool Launch::rejects_wheels(const inputs::WheelInterval& interval, const std::array<double, 2>& sigma) {
  model::MotionWindow& window = mechanisation_.window();
  if (window.duration() <= 0.5 * interval.duration()) return false;
  const Speeds now{interval.mean_speed(), window.motion().velocity.x()};
  note_leap(now);
  const auto beyond = [&](double share, double sigmas) {
    return all_beyond(share, sigmas, belief_, window.motion(), interval, sigma, geometry_);
  };
  suspicious_ = !jolted_ && beyond(kNearly, kLikely);
  const bool grown = largest_leap_ < kAtOnce * std::abs(now.imu - now.wheels);
  disagreed_ = suspicious_ && grown && beyond(kWrong, kSure) ? disagreed_ + 1 : 0;
  return disagreed_ >= kIntervals;
}

bool Launch::agrees(const model::Belief& belief, const model::BodyMotion& motion, const inputs::WheelInterval& interval,
                    const std::array<double, 2>& sigma, const model::Geometry& geometry) {
  return !all_beyond(kNearly, kLikely, belief, motion, interval, sigma, geometry);
}

void Launch::inflate_covariance(model::Estimate& estimate, const model::Belief& of_filter) const {
  if (!suspicious_) return;
  const Eigen::Vector3d position_difference = of_filter.mean.position - belief_.mean.position;
  const double speed_difference = of_filter.mean.velocity.x() - belief_.mean.velocity.x();
  estimate.pose_covariance.topLeftCorner<3, 3>() += position_difference * position_difference.transpose();
  estimate.twist_covariance(0, 0) += speed_difference * speed_difference;
}

}  // namespace curbstone::ekf::filter
