#include "services/mapper/motion_expectation.hpp"

#include <algorithm>

namespace curbstone {
namespace {

constexpr double kAcceleration = 10.0;  // m/s a revolution's time, what velocity may be off by without odometry
constexpr double kTurning = 2.0;        // rad/s, the same for rotation
constexpr double kLongestGuess = 2.5;   // s that a vehicle is thought to have gone on as it did
constexpr double kBasin = 0.7;          // m between two beginnings, each of which registration finds its way from
constexpr double kMostAhead = 5.0;      // m a revolution that are sought
constexpr double kTurned = 0.05;        // rad between such beginnings

Matrix6 isotropic(double translation, double rotation) {
  Vector6 diagonal;
  diagonal << Eigen::Vector3d::Constant(translation * translation), Eigen::Vector3d::Constant(rotation * rotation);
  return diagonal.asDiagonal();
}

}  // namespace

MotionExpectation expect_motion(const MapperConfig& config, const RecentMotion& recent, const Revolution& revolution,
                                const OdometryHistory& odometry) {
  const std::int64_t from = std::min(recent.end, revolution.start);
  if (!odometry.covers(from, revolution.end)) {
    MotionExpectation steady = expect_steady(recent, revolution);
    if (odometry.covers(revolution.start, revolution.end)) {
      steady.sweep = sweep_from(odometry, revolution.start, revolution.end);  // it is back after a gap
    }
    return steady;
  }
  MotionExpectation expected;
  expected.with_odometry = true;
  expected.T_last_base = odometry.at(recent.end).inverse() * odometry.at(revolution.end);
  const double moved = expected.T_last_base.translation().norm();
  const double turned = angle_of(expected.T_last_base);
  const double stride = std::max(seconds(recent.end, revolution.end), 0.02);
  if (moved > config.max_speed * stride || turned > config.max_turn * stride) {
    MotionExpectation steady = expect_steady(recent, revolution);  // the filter began again, or jumped
    steady.incredible = true;
    return steady;
  }
  expected.stationary = odometry.stationary(from, revolution.end);
  expected.sweep = sweep_from(odometry, revolution.start, revolution.end);
  expected.covariance = isotropic(config.prior_floor_m + config.prior_translation * moved,
                                  config.prior_floor_rad + config.prior_rotation * turned);
  expected.deskew_covariance = isotropic(0.5 * config.prior_translation * moved, 0.5 * config.prior_rotation * turned);
  return expected;
}

MotionExpectation expect_steady(const RecentMotion& recent, const Revolution& revolution) {
  double stride = seconds(recent.end, revolution.end);
  MotionExpectation expected;
  expected.blind = stride > kLongestStride;
  if (stride > kLongestGuess) stride = recent.stride;  // or a new clock: who can say how far it went
  expected.T_last_base = move(recent.twist, stride);
  expected.sweep = steady_sweep(recent.twist, seconds(revolution.start, revolution.end));
  expected.covariance = isotropic(kAcceleration * std::max(stride, 0.05), kTurning * std::max(stride, 0.05));
  return expected;
}

MotionExpectation expect_perhaps(const Twist& twist, std::int64_t from, const Revolution& revolution) {
  MotionExpectation expected = expect_steady({from, twist, seconds(from, revolution.end)}, revolution);
  Vector6 sigma;  // no vehicle rolls, pitches or heaves by much within a revolution
  sigma << kBasin, kBasin, 0.2, 0.05, 0.05, 0.1;
  expected.covariance = sigma.cwiseAbs2().asDiagonal();
  return expected;
}

std::vector<Twist> first_motions(double max_speed, double stride) {
  const double most = std::min(max_speed * stride, kMostAhead);
  std::vector<Twist> motions(1);
  for (double ahead = kBasin; ahead < most + kBasin / 2; ahead += kBasin) {
    motions.push_back(twist_of(Pose(Eigen::Translation3d(ahead, 0, 0)), stride));
    if (motions.size() == 2) motions.push_back(twist_of(Pose(Eigen::Translation3d(-ahead, 0, 0)), stride));
  }
  return motions;
}

std::vector<Twist> other_motions(const Twist& expected, double stride) {
  std::vector<Twist> motions;
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

}  // namespace curbstone
