#include "services/mapper/tracking/scan_to_scan_motion.hpp"

#include <cmath>
#include <utility>

#include "services/mapper/registration/make_registration.hpp"

namespace curbstone::mapper::tracking {
namespace {

constexpr std::int64_t kMaxPairInterval = 300'000;  // us
constexpr double kNear = 0.05;                      // m from odometry's way, below which both have the same agreement

constexpr double kHypothesisAgreementRatio = 1.02;  // factor in agreement by which a less likely way must be better

/// Prior around a guess with 1 sigma of `way`, m, in the plane and of `turn`, rad.
registration::PosePrior around(const Pose& guess, double odometry_check, double turn) {
  registration::Vector6 sigma;
  sigma << odometry_check, odometry_check, 0.02, turn, turn, turn;
  registration::PosePrior prior;
  prior.T_map_base = guess;
  prior.information = sigma.cwiseAbs2().cwiseInverse().asDiagonal();
  prior.reach = ScanToScanMotion::kMaxDeviation;
  return prior;
}

/// Largest 1 sigma over the directions in the plane, m.
double worst_of(const registration::Matrix6& covariance) {
  const Eigen::Matrix2d plane = covariance.topLeftCorner<2, 2>();
  return std::sqrt(0.5 * plane.trace() + std::hypot(0.5 * (plane(0, 0) - plane(1, 1)), plane(0, 1)));
}

double agreement(const registration::RegistrationResult& found) {
  return found.overlap * found.inlier_ratio;
}

}  // namespace

std::optional<OdometryCheck::Pair> ScanToScanMotion::take(std::int64_t utime,
                                                          const std::vector<scan::LidarPoint>& points,
                                                          const Pose& T_odom_base, bool is_suspect, bool multi_start) {
  if (first_ && (utime <= first_->utime || utime - first_->utime > kMaxPairInterval)) first_.reset();
  if (first_) {
    if (utime - first_->utime < kMinInterval) return std::nullopt;
    auto pair = measure(points, first_->T_odom_base.inverse() * T_odom_base, multi_start);
    if (pair) pair->seconds = scan::seconds(first_->utime, utime);
    if (pair) pair->utime = utime;
    first_.reset();
    measured_ = utime;
    return pair;
  }
  if (std::abs(utime - measured_) < (is_suspect ? kShortPeriod : kPeriod)) return std::nullopt;
  first_ = First{utime, T_odom_base, registration::make_registration(config_, lidar_)};
  first_->map->insert(points, Pose::Identity());
  return std::nullopt;
}

std::optional<OdometryCheck::Pair> ScanToScanMotion::measure(const std::vector<scan::LidarPoint>& points,
                                                             const Pose& by_odometry, bool multi_start) const {
  std::vector<Pose> guesses = {by_odometry};
  if (multi_start) {
    guesses.push_back(by_odometry);
    guesses.back().translation().setZero();
    guesses.push_back(by_odometry);
    guesses.back().translation() *= -1;
  }
  std::optional<registration::RegistrationResult> best;
  for (const Pose& guess : guesses) {
    const registration::RegistrationResult found = first_->map->align(points, around(guess, kMaxDeviation, 0.005));
    if (!found.converged || (found.degenerate & registration::kPlanarAxes) != 0) continue;
    if (!best || agreement(found) > kHypothesisAgreementRatio * agreement(*best)) best = found;
  }
  if (!best) return std::nullopt;
  OdometryCheck::Pair pair;
  pair.by_odometry = by_odometry.translation().head<2>();
  pair.by_scans = best->T_map_base.translation().head<2>();
  pair.sigma = worst_of(best->covariance);
  pair.agreement = agreement(*best);
  const bool near = (pair.by_scans - pair.by_odometry).norm() < kNear;
  pair.agreement_with_odometry = agreement(near ? *best : first_->map->align(points, around(by_odometry, 1e-4, 1e-3)));
  return pair;
}

}  // namespace curbstone::mapper::tracking
