#include "services/mapper/revolution_fitter.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "services/mapper/make_registration.hpp"

namespace curbstone {
namespace {

constexpr int kDeskewPasses = 2;         // without odometry, after the first
constexpr double kSettledShift = 0.01;   // m over a revolution, and
constexpr double kSettledTurn = 1e-3;    // rad: de-skewed with a motion that is off by less, it is right
constexpr double kRefined = 0.15;        // m, that such a pass may find its points off
constexpr double kLever = 15.0;          // m, at which most of what is registered stands
constexpr int kPairPasses = 3;           // of the first two revolutions
constexpr double kClearlyBetter = 1.02;  // agreement that makes a less likely speed the better answer

/// s from when its points were taken, in the mean, to its end.
double mean_age(const Revolution& revolution) {
  double sum = 0;
  std::size_t n = 0;
  for (const LidarPoint& point : revolution.points) {
    if (measured(point)) sum += static_cast<double>(point.time), ++n;
  }
  return seconds(revolution.start, revolution.end) - sum / static_cast<double>(std::max<std::size_t>(n, 1));
}

/// Whether two motions de-skew alike.
bool alike(const Twist& a, const Twist& b, double sweep_seconds) {
  return (a.linear - b.linear).norm() * sweep_seconds < kSettledShift &&
         (a.angular - b.angular).norm() * sweep_seconds < kSettledTurn;
}

/// Where the vehicle sees itself. The ground under it is no part of it.
Eigen::AlignedBox3f body_of(const VehicleConfig& vehicle) {
  constexpr double kMargin = 0.1;  // m
  const double half_length = 0.5 * vehicle.length + kMargin;
  const double half_width = 0.5 * vehicle.width + kMargin;
  const Eigen::Vector3d rear_right(vehicle.middle - half_length, -half_width, kMargin);
  const Eigen::Vector3d front_left(vehicle.middle + half_length, half_width, vehicle.height + kMargin);
  return {rear_right.cast<float>(), front_left.cast<float>()};
}

bool clearly_better(const Fit& fit, const Fit& than) {
  return fit.result.converged && fit.agreement() > kClearlyBetter * than.agreement();
}

}  // namespace

RevolutionFitter::RevolutionFitter(const MapperConfig& config)
    : config_(config),
      T_base_lidar_(config.vehicle.T_base_lidar()),
      own_body_(body_of(config.vehicle)),
      registration_(make_registration(config)) {}

void RevolutionFitter::clear_map() {
  registration_ = make_registration(config_);
}

std::vector<LidarPoint> RevolutionFitter::in_base(const Revolution& revolution, const SweepMotion& sweep) const {
  std::vector<LidarPoint> points = deskew(revolution.points, T_base_lidar_, sweep);
  std::erase_if(points, [this](const LidarPoint& p) { return own_body_.contains(p.position); });
  return points;
}

Fit RevolutionFitter::expect(const Departure& from, const Revolution& revolution, MotionExpectation expected) const {
  Fit fit;
  fit.prior.T_map_base = normalised(from.T_map_base * expected.T_last_base);
  const Matrix6 covariance = from.drift + expected.covariance;
  fit.prior.information = covariance.inverse();
  fit.prior.reach = 3 * (std::sqrt(covariance(0, 0)) + kLever * std::sqrt(covariance(3, 3)));
  fit.expected = std::move(expected);
  fit.points = in_base(revolution, fit.expected.sweep);
  return fit;
}

Fit RevolutionFitter::fit(const Departure& from, const Revolution& revolution, MotionExpectation expected,
                          const MotionFilter& motion) {
  Fit fit = expect(from, revolution, std::move(expected));
  fit.motion = motion;
  fit.result = registration_->align(fit.points, fit.prior);
  if (!fit.expected.with_odometry && seconds(from.end, revolution.end) <= kLongestStride) {
    refine_motion(from, revolution, motion, fit);
  }
  return fit;
}

/// What registration found says more of the motion during the revolution than the expectation did: de-skew with that,
/// and register again.
void RevolutionFitter::refine_motion(const Departure& from, const Revolution& revolution, const MotionFilter& before,
                                     Fit& fit) {
  const double sweep_seconds = seconds(revolution.start, revolution.end);
  MotionFilter::Found found;
  found.assumed = before.twist();
  found.age = mean_age(revolution);
  found.stride = seconds(from.end, revolution.end);
  PosePrior prior = fit.prior;
  for (int pass = 0; fit.result.converged; ++pass) {
    found.T_last_base = from.T_map_base.inverse() * fit.result.T_map_base;
    fit.motion = before;
    fit.result.T_map_base = normalised(from.T_map_base * fit.motion.take(found));
    const Twist& twist = fit.motion.twist();
    fit.points = in_base(revolution, steady_sweep(twist, sweep_seconds));
    if (pass == kDeskewPasses || alike(twist, found.assumed, sweep_seconds)) break;
    found.assumed = twist;
    prior.T_map_base = fit.result.T_map_base;
    prior.reach = kRefined;
    fit.result = registration_->align(fit.points, prior);
  }
}

Fit RevolutionFitter::fit_from_afar(const Departure& from, const Revolution& revolution, const MotionFilter& motion) {
  Fit best;
  for (const Twist& twist : other_motions(motion.twist(), seconds(from.end, revolution.end))) {
    MotionFilter other;
    other.set(twist);
    Fit found = fit(from, revolution, expect_perhaps(twist, from.end, revolution), other);
    if (clearly_better(found, best)) best = std::move(found);
  }
  return best;
}

/// De-skewed with the same motion both show the same distortion, so what lies between them is right from the first pass
/// on; the next ones put the distortion right.
Fit RevolutionFitter::fit_second(const Departure& from, const Revolution& first, const Revolution& second,
                                 std::vector<LidarPoint>& first_points) {
  const double stride = seconds(from.end, second.end);
  const auto fit_with = [&](Twist twist) {
    Fit fit;
    for (int pass = 0; pass < kPairPasses; ++pass) {
      clear_map();
      first_points = in_base(first, steady_sweep(twist, seconds(first.start, first.end)));
      registration_->insert(first_points, from.T_map_base);
      fit = expect(from, second, expect_perhaps(twist, from.end, second));
      if (pass > 0) fit.prior.reach = kRefined;
      fit.result = registration_->align(fit.points, fit.prior);
      if (!fit.result.converged) break;
      twist = twist_of(from.T_map_base.inverse() * fit.result.T_map_base, stride);
    }
    fit.motion.set(twist);
    return fit;
  };
  Fit best;
  bool last_is_best = false;
  for (const Twist& twist : first_motions(config_.max_speed, stride)) {
    Fit fit = fit_with(twist);
    last_is_best = clearly_better(fit, best);
    if (last_is_best) best = std::move(fit);
  }
  if (last_is_best) return best;
  return fit_with(best.motion.twist());
}

}  // namespace curbstone
