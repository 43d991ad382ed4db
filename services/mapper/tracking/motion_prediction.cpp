#include "services/mapper/tracking/motion_prediction.hpp"

#include <algorithm>

namespace curbstone::mapper::tracking {
namespace {

constexpr double kSpeedError = 10.0;       // m/s, 1 sigma of a constant velocity without odometry
constexpr double kTurnRateError = 2.0;     // rad/s, likewise of its turn
constexpr double kMaxExtrapolation = 2.5;  // s for which a constant velocity is extrapolated
constexpr double kConvergenceBasin = 0.7;  // m between two initial motions, from one of which registration converges
constexpr double kMaxInitialMotion = 5.0;  // m per scan, largest initial motion
constexpr double kTurned = 0.05;           // rad between initial motions
constexpr double kMaxBraking = 4.0;        // m/s^2
constexpr double kDrift = 0.05;            // m per metre of odometry without registration,
constexpr double kTurnDrift = 0.005;       // and rad per metre

registration::Matrix6 isotropic(double translation, double rotation) {
  registration::Vector6 diagonal;
  diagonal << Eigen::Vector3d::Constant(translation * translation), Eigen::Vector3d::Constant(rotation * rotation);
  return diagonal.asDiagonal();
}

}  // namespace

MotionPrediction predict_motion(const config::TrackerConfig& config, const RecentMotion& recent, const scan::Scan& scan,
                                const scan::OdometryHistory& odometry) {
  const std::int64_t from = std::min(recent.end, scan.start);
  if (!odometry.covers(from, scan.end)) {
    MotionPrediction steady = predict_constant_velocity(recent, scan);
    if (odometry.covers(scan.start, scan.end)) {
      steady.sweep = scan::sweep_from(odometry, scan.start, scan.end);  // odometry is back after a gap
    }
    return steady;
  }
  MotionPrediction prediction;
  prediction.with_odometry = true;
  prediction.T_last_base = odometry.at(recent.end).inverse() * odometry.at(scan.end);
  const double moved = prediction.T_last_base.translation().norm();
  const double turned = angle_of(prediction.T_last_base);
  const double stride = std::max(scan::seconds(recent.end, scan.end), 0.02);
  if (moved > config.max_speed * stride || turned > config.max_turn * stride) {
    MotionPrediction steady = predict_constant_velocity(recent, scan);  // the filter restarted, or jumped
    steady.implausible = true;
    return steady;
  }
  prediction.stationary = odometry.stationary(from, scan.end);
  prediction.sweep = scan::sweep_from(odometry, scan.start, scan.end);
  prediction.covariance = isotropic(config.prior_floor_m + config.prior_translation * moved,
                                    config.prior_floor_rad + config.prior_rotation * turned);
  prediction.deskew_covariance =
      isotropic(0.5 * config.prior_translation * moved, 0.5 * config.prior_rotation * turned);
  return prediction;
}

std::optional<MotionPrediction> predict_across_gap(const config::TrackerConfig& config, const RecentMotion& recent,
                                                   const Pose& T_odom_last, const scan::Scan& scan,
                                                   const scan::OdometryHistory& odometry) {
  if (!odometry.covers(scan.start, scan.end)) return std::nullopt;
  MotionPrediction prediction;
  prediction.with_odometry = true;
  prediction.T_last_base = T_odom_last.inverse() * odometry.at(scan.end);
  const double seconds = scan::seconds(recent.end, scan.end);
  const Pose steady = scan::move(recent.twist, seconds);
  const double path = prediction.T_last_base.translation().norm();
  const double unexpected = (prediction.T_last_base.translation() - steady.translation()).norm();
  if (unexpected > kMaxBraking * seconds * seconds + 1.0 || path > config.max_speed * seconds) return std::nullopt;
  prediction.sweep = scan::sweep_from(odometry, scan.start, scan.end);
  prediction.covariance = isotropic(config.prior_floor_m + kDrift * path, config.prior_floor_rad + kTurnDrift * path);
  return prediction;
}

MotionPrediction predict_constant_velocity(const RecentMotion& recent, const scan::Scan& scan) {
  double stride = scan::seconds(recent.end, scan.end);
  MotionPrediction prediction;
  prediction.blind = stride > kMaxStride;
  if (stride > kMaxExtrapolation) stride = recent.stride;  // too long ago, or a new clock: the way is unknown
  prediction.T_last_base = scan::move(recent.twist, stride);
  prediction.sweep = scan::steady_sweep(recent.twist, scan::seconds(scan.start, scan.end));
  prediction.covariance = isotropic(kSpeedError * std::max(stride, 0.05), kTurnRateError * std::max(stride, 0.05));
  return prediction;
}

MotionPrediction predict_from_hypothesis(const scan::Twist& twist, std::int64_t from, const scan::Scan& scan) {
  MotionPrediction prediction = predict_constant_velocity({from, twist, scan::seconds(from, scan.end)}, scan);
  registration::Vector6 sigma;  // roll, pitch and height change little within a scan
  sigma << kConvergenceBasin, kConvergenceBasin, 0.2, 0.05, 0.05, 0.1;
  prediction.covariance = sigma.cwiseAbs2().asDiagonal();
  return prediction;
}

std::vector<scan::Twist> initial_motion_hypotheses(double max_speed, double stride) {
  const double most = std::min(max_speed * stride, kMaxInitialMotion);
  std::vector<scan::Twist> motions(1);
  for (double ahead = kConvergenceBasin; ahead < most + kConvergenceBasin / 2; ahead += kConvergenceBasin) {
    motions.push_back(scan::twist_of(Pose(Eigen::Translation3d(ahead, 0, 0)), stride));
    if (motions.size() == 2) motions.push_back(scan::twist_of(Pose(Eigen::Translation3d(-ahead, 0, 0)), stride));
  }
  return motions;
}

std::vector<scan::Twist> nearby_motion_hypotheses(const scan::Twist& prediction, double stride) {
  std::vector<scan::Twist> motions;
  for (const double turned : {kTurned, -kTurned, 2 * kTurned, -2 * kTurned}) {
    motions.push_back(prediction);
    motions.back().angular.z() += turned / stride;
  }
  for (const double ahead : {kConvergenceBasin, -kConvergenceBasin}) {
    motions.push_back(prediction);
    motions.back().linear.x() += ahead / stride;
  }
  return motions;
}

}  // namespace curbstone::mapper::tracking
