#include "services/mapper/tracking/scan_matcher.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/config/own_body.hpp"
#include "common/linear/decompositions.hpp"
#include "services/mapper/registration/make_registration.hpp"

namespace curbstone::mapper::tracking {
namespace {

constexpr int kDeskewPasses = 2;               // additional passes without odometry
constexpr double kSettledShift = 0.01;         // m over a scan,
constexpr double kSettledTurn = 1e-3;          // and rad: errors of the motion below which de-skew is good enough
constexpr double kRefinementReach = 0.15;      // m, reach of the registration in such a pass
constexpr double kLever = 15.0;                // m, typical range of the points
constexpr int kPairPasses = 3;                 // for the first two scans
constexpr double kSpeedAgreementRatio = 1.02;  // factor in agreement by which a less likely speed must be better

/// s from the mean time of a scan's points to its end.
double mean_age(const scan::Scan& scan) {
  double sum = 0;
  std::size_t n = 0;
  for (const scan::LidarPoint& point : scan.points) {
    if (scan::measured(point)) sum += static_cast<double>(point.time), ++n;
  }
  return scan::seconds(scan.start, scan.end) - sum / static_cast<double>(std::max<std::size_t>(n, 1));
}

/// Whether two motions de-skew a scan alike, within kSettledShift and kSettledTurn.
bool alike(const scan::Twist& a, const scan::Twist& b, double sweep_seconds) {
  return (a.linear - b.linear).norm() * sweep_seconds < kSettledShift &&
         (a.angular - b.angular).norm() * sweep_seconds < kSettledTurn;
}

bool clearly_better(const Fit& fit, const Fit& than) {
  return fit.result.converged && fit.agreement() > kSpeedAgreementRatio * than.agreement();
}

}  // namespace

ScanMatcher::ScanMatcher(const config::RegistrationConfig& config, const VehicleConfig& vehicle, double max_speed)
    : config_(config),
      max_speed_(max_speed),
      T_base_lidar_(vehicle.T_base_lidar()),
      R_base_lidar_(T_base_lidar_.linear()),
      own_body_(curbstone::own_body(vehicle)),
      registration_(registration::make_registration(config, T_base_lidar_.translation())) {}

std::unique_ptr<registration::Registration> ScanMatcher::empty_map() const {
  return registration::make_registration(config_, T_base_lidar_.translation());
}

void ScanMatcher::set_mount_yaw(double yaw) {
  T_base_lidar_.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) * R_base_lidar_;
}

std::vector<scan::LidarPoint> ScanMatcher::in_base(const scan::Scan& scan, const scan::SweepMotion& sweep) const {
  std::vector<scan::LidarPoint> points = scan::deskew(scan.points, T_base_lidar_, sweep);
  std::erase_if(points, [this](const scan::LidarPoint& p) { return own_body_.contains(p.position); });
  return points;
}

Fit ScanMatcher::predict(const PreviousPose& from, const scan::Scan& scan, MotionPrediction prediction) const {
  Fit fit;
  fit.prior.T_map_base = normalised(from.T_map_base * prediction.T_last_base);
  const registration::Matrix6 covariance = from.drift + prediction.covariance;
  fit.prior.information = inverse(covariance);
  fit.prior.reach = 3 * (std::sqrt(covariance(0, 0)) + kLever * std::sqrt(covariance(3, 3)));
  fit.prediction = std::move(prediction);
  fit.points = in_base(scan, fit.prediction.sweep);
  return fit;
}

Fit ScanMatcher::fit(const PreviousPose& from, const scan::Scan& scan, MotionPrediction prediction,
                     const MotionFilter& motion) {
  Fit fit = predict(from, scan, std::move(prediction));
  fit.motion = motion;
  fit.result = registration_->align(fit.points, fit.prior);
  if (!fit.prediction.with_odometry && scan::seconds(from.end, scan.end) <= kMaxStride) {
    return refine_motion(from, scan, motion, std::move(fit));
  }
  return fit;
}

/// The registration result gives a better motion during the scan than the prediction: de-skews with that motion and
/// registers again.
Fit ScanMatcher::refine_motion(const PreviousPose& from, const scan::Scan& scan, const MotionFilter& before, Fit fit) {
  const double sweep_seconds = scan::seconds(scan.start, scan.end);
  MotionFilter::Found found;
  found.assumed = before.twist();
  found.age = mean_age(scan);
  found.stride = scan::seconds(from.end, scan.end);
  registration::PosePrior prior = fit.prior;
  for (int pass = 0; fit.result.converged; ++pass) {
    found.T_last_base = from.T_map_base.inverse() * fit.result.T_map_base;
    fit.motion = before;
    fit.result.T_map_base = normalised(from.T_map_base * fit.motion.take(found));
    const scan::Twist& twist = fit.motion.twist();
    fit.points = in_base(scan, scan::steady_sweep(twist, sweep_seconds));
    if (pass == kDeskewPasses || alike(twist, found.assumed, sweep_seconds)) break;
    found.assumed = twist;
    prior.T_map_base = fit.result.T_map_base;
    prior.reach = kRefinementReach;
    fit.result = registration_->align(fit.points, prior);
  }
  return fit;
}

Fit ScanMatcher::fit_multi_start(const PreviousPose& from, const scan::Scan& scan, const MotionFilter& motion) {
  Fit best;
  for (const scan::Twist& twist : nearby_motion_hypotheses(motion.twist(), scan::seconds(from.end, scan.end))) {
    MotionFilter other;
    other.set(twist);
    Fit found = fit(from, scan, predict_from_hypothesis(twist, from.end, scan), other);
    if (clearly_better(found, best)) best = std::move(found);
  }
  return best;
}

/// Two scans de-skewed with the same motion have the same distortion, so the motion between them is right from the
/// first pass on; the further passes remove the distortion.
Fit ScanMatcher::fit_second(const PreviousPose& from, const scan::Scan& first, const scan::Scan& second) {
  const double stride = scan::seconds(from.end, second.end);
  const auto fit_with = [&](scan::Twist twist) {
    Fit fit;
    for (int pass = 0; pass < kPairPasses; ++pass) {
      clear_map();
      std::vector<scan::LidarPoint> first_points =
          in_base(first, scan::steady_sweep(twist, scan::seconds(first.start, first.end)));
      registration_->insert(first_points, from.T_map_base);
      fit = predict(from, second, predict_from_hypothesis(twist, from.end, second));
      fit.first_points = std::move(first_points);
      if (pass > 0) fit.prior.reach = kRefinementReach;
      fit.result = registration_->align(fit.points, fit.prior);
      if (!fit.result.converged) break;
      twist = scan::twist_of(from.T_map_base.inverse() * fit.result.T_map_base, stride);
    }
    fit.motion.set(twist);
    return fit;
  };
  Fit best;
  bool last_is_best = false;
  for (const scan::Twist& twist : initial_motion_hypotheses(max_speed_, stride)) {
    Fit fit = fit_with(twist);
    last_is_best = clearly_better(fit, best);
    if (last_is_best) best = std::move(fit);
  }
  if (last_is_best) return best;
  return fit_with(best.motion.twist());
}

}  // namespace curbstone::mapper::tracking
