#include "services/mapper/tracking/motion_expectation.hpp"

#include <algorithm>

namespace curbstone::mapper::tracking {
namespace {

constexpr double kAcceleration = 10.0;     // m/s, error of the velocity over a scan without odometry
constexpr double kTurning = 2.0;           // rad/s, likewise of the rotation
constexpr double kLongestGuess = 2.5;      // s for which a constant velocity is extrapolated
constexpr double kBasin = 0.7;             // m between two initial motions, from one of which registration converges
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

MotionExpectation expect_motion(const config::TrackerConfig& config, const RecentMotion& recent, const scan::Scan& scan,
                                const scan::OdometryHistory& odometry) {
  const std::int64_t from = std::min(recent.end, scan.start);
  if (!odometry.covers(from, scan.end)) {
    MotionExpectation steady = expect_steady(recent, scan);
    if (odometry.covers(scan.start, scan.end)) {
      steady.sweep = scan::sweep_from(odometry, scan.start, scan.end);  // odometry is back after a gap
    }
    return steady;
  }
  MotionExpectation expected;
  expected.with_odometry = true;
  expected.T_last_base = odometry.at(recent.end).inverse() * odometry.at(scan.end);
  const double moved = expected.T_last_base.translation().norm();
  const double turned = angle_of(expected.T_last_base);
  const double stride = std::max(scan::seconds(recent.end, scan.end), 0.02);
  if (moved > config.max_speed * stride || turned > config.max_turn * stride) {
    MotionExpectation steady = expect_steady(recent, scan);  // the filter restarted, or jumped
    steady.incredible = true;
    return steady;
  }
  expected.stationary = odometry.stationary(from, scan.end);
  expected.sweep = scan::sweep_from(odometry, scan.start, scan.end);
  expected.covariance = isotropic(config.prior_floor_m + config.prior_translation * moved,
                                  config.prior_floor_rad + config.prior_rotation * turned);
  expected.deskew_covariance = isotropic(0.5 * config.prior_translation * moved, 0.5 * config.prior_rotation * turned);
  return expected;
}

std::optional<MotionExpectation> expect_across(const config::TrackerConfig& config, const RecentMotion& recent,
                                               const Pose& T_odom_last, const scan::Scan& scan,
                                               const scan::OdometryHistory& odometry) {
  if (!odometry.covers(scan.start, scan.end)) return std::nullopt;
  MotionExpectation expected;
  expected.with_odometry = true;
  expected.T_last_base = T_odom_last.inverse() * odometry.at(scan.end);
  const double seconds = scan::seconds(recent.end, scan.end);
  const Pose steady = scan::move(recent.twist, seconds);
  const double path = expected.T_last_base.translation().norm();
  const double unexpected = (expected.T_last_base.translation() - steady.translation()).norm();
  if (unexpected > kMaxBraking * seconds * seconds + 1.0 || path > config.max_speed * seconds) return std::nullopt;
  expected.sweep = scan::sweep_from(odometry, scan.start, scan.end);
  expected.covariance = isotropic(config.prior_floor_m + kDrift * path, config.prior_floor_rad + kTurnDrift * path);
  return expected;
}

MotionExpectation expect_steady(const RecentMotion& recent, const scan::Scan& scan) {
  double stride = scan::seconds(recent.end, scan.end);
  MotionExpectation expected;
  expected.blind = stride > kLongestStride;
  if (stride > kLongestGuess) stride = recent.stride;  // too long ago, or a new clock: the way is unknown
  expected.T_last_base = scan::move(recent.twist, stride);
  expected.sweep = scan::steady_sweep(recent.twist, scan::seconds(scan.start, scan.end));
  expected.covariance = isotropic(kAcceleration * std::max(stride, 0.05), kTurning * std::max(stride, 0.05));
  return expected;
}

MotionExpectation expect_perhaps(const scan::Twist& twist, std::int64_t from, const scan::Scan& scan) {
  MotionExpectation expected = expect_steady({from, twist, scan::seconds(from, scan.end)}, scan);
  registration::Vector6 sigma;  // roll, pitch and height change little within a scan
  sigma << kBasin, kBasin, 0.2, 0.05, 0.05, 0.1;
  expected.covariance = sigma.cwiseAbs2().asDiagonal();
  return expected;
}

std::vector<scan::Twist> first_motions(double max_speed, double stride) {
  const double most = std::min(max_speed * stride, kMaxInitialMotion);
  std::vector<scan::Twist> motions(1);
  for (double ahead = kBasin; ahead < most + kBasin / 2; ahead += kBasin) {
    motions.push_back(scan::twist_of(Pose(Eigen::Translation3d(ahead, 0, 0)), stride));
    if (motions.size() == 2) motions.push_back(scan::twist_of(Pose(Eigen::Translation3d(-ahead, 0, 0)), stride));
  }
  return motions;
}

std::vector<scan::Twist> other_motions(const scan::Twist& expected, double stride) {
  std::vector<scan::Twist> motions;
  for (const double turned : {kTurned, -kTurned, 2 * kTurned, -2 * kTurned}) {
    motions.push_back(expected);
    motions.back().angular.z() += turned / stride;
  }
  for (const double ahead : {kBasin, -kBasin}) {
    motions.push_back(expected);
    motions.back().linear.x() += ahead / stride;
  }
  return motions;
}

}  // namespace curbstone::mapper::tracking
