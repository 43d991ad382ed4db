#include "tools/calibrate/calibration.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tools/calibrate/calibration_solver.hpp"
#include "tools/calibrate/segment.hpp"

namespace curbstone::calibrate {

namespace {

constexpr double kPiece = 0.5;  // s
constexpr std::size_t kMinSegments = 20;
constexpr double kShare = 0.9;  // share of the information from the drive for a parameter to be observed
constexpr double kOpen = 0.5;   // remaining share of the prior's variance for a direction to be open

struct Described {
  const char* name;
  const char* unit;
  double useful;  // largest useful value of 1 sigma; radii and track: relative
};
constexpr std::array<Described, kCalibratedCount> kDescribed = {{{"wheel_radius.left", "m", 0.005},
                                                                 {"wheel_radius.right", "m", 0.005},
                                                                 {"track_width", "m", 0.02},
                                                                 {"lidar.x", "m", 0.05},
                                                                 {"lidar.y", "m", 0.05},
                                                                 {"lidar.z", "m", 0.05},
                                                                 {"lidar.roll", "rad", 0.01},
                                                                 {"lidar.pitch", "rad", 0.01},
                                                                 {"lidar.yaw", "rad", 0.01},
                                                                 {"imu.x", "m", 0.05},
                                                                 {"imu.y", "m", 0.05},
                                                                 {"imu.z", "m", 0.05},
                                                                 {"imu.roll", "rad", 0.01},
                                                                 {"imu.pitch", "rad", 0.01},
                                                                 {"imu.yaw", "rad", 0.01}}};

std::vector<OpenDirection> open_directions(const Eigen::MatrixXd& covariance, const Eigen::VectorXd& prior) {
  const Eigen::MatrixXd scaled = prior.cwiseInverse().asDiagonal() * covariance * prior.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
  std::vector<OpenDirection> out;
  for (Eigen::Index k = 0; k < eigen.eigenvalues().size(); ++k) {
    if (eigen.eigenvalues()[k] < kOpen) continue;
    OpenDirection direction;
    for (std::size_t i = 0; i < kCalibratedCount; ++i) {
      const double part = eigen.eigenvectors()(static_cast<Eigen::Index>(i), k);
      if (std::abs(part) > 0.3) direction.parts.emplace_back(kDescribed[i].name, part);
    }
    out.push_back(std::move(direction));
  }
  return out;
}

using Values = std::array<double, kCalibratedCount>;

Values configured_values(const VehicleConfig& vehicle) {
  Values values = {vehicle.wheel_radius, vehicle.wheel_radius, vehicle.track_width};
  std::copy_n(vehicle.lidar.begin(), 6, values.begin() + 3);
  std::copy_n(vehicle.imu.begin(), 6, values.begin() + 9);
  return values;
}

/// Fills in each value, its sigma, and whether it is observed. The result must have its covariance.
void describe_values(const CalibrationSolver& solver, const Values& configured, CalibrationResult& result) {
  const auto found = solver.values();
  const auto prior = solver.prior_sigma();
  for (std::size_t i = 0; i < kCalibratedCount; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    CalibratedValue& v = result.values[i];
    v.name = kDescribed[i].name;
    v.unit = kDescribed[i].unit;
    v.configured = configured[i];
    v.value = found[i];
    v.sigma = std::sqrt(result.covariance(k, k));
    v.share = 1.0 - v.sigma * v.sigma / (prior[i] * prior[i]);
    v.observed = v.share > kShare && v.sigma < kDescribed[i].useful * (i < 3 ? configured[i] : 1.0);
  }
}

/// The vehicle with the observed parameters replaced.
VehicleConfig with_observed(VehicleConfig vehicle, const CalibrationResult& result) {
  const CalibratedValue& left = result[Calibrated::kRadiusLeft];
  const CalibratedValue& right = result[Calibrated::kRadiusRight];
  const CalibratedValue& track = result[Calibrated::kTrack];
  if (left.observed && right.observed) vehicle.wheel_radius = 0.5 * (left.value + right.value);
  if (track.observed) vehicle.track_width = track.value;
  for (std::size_t i = 0; i < 6; ++i) {
    if (result.values[3 + i].observed) vehicle.lidar[i] = result.values[3 + i].value;
    if (result.values[9 + i].observed) vehicle.imu[i] = result.values[9 + i].value;
  }
  return vehicle;
}

}  // namespace

CalibrationResult calibrate(const CalibrationData& data, const VehicleConfig& vehicle) {
  const std::vector<CalibrationSegment> segments = cut_segments(data, kPiece);
  if (segments.size() < kMinSegments)
    throw std::runtime_error(fmt::format(
        "too little to calibrate with: {} pieces of {} s in which the vehicle moves and LiDAR, wheels and IMU "
        "are all heard; {} are needed",
        segments.size(), kPiece, kMinSegments));
  CalibrationSolver solver(segments, vehicle);
  solver.solve();

  CalibrationResult result;
  result.segments = static_cast<int>(segments.size());
  for (const CalibrationSegment& s : segments) {
    result.distance += s.T_begin_end().translation().norm();
    result.turned += angle_of(s.T_begin_end());
  }
  result.noise = {solver.noise()[kAlong], solver.noise()[kGyro], solver.noise()[kSpeed]};
  constexpr auto n = static_cast<Eigen::Index>(kCalibratedCount);
  const Eigen::MatrixXd all = solver.information().inverse();
  result.covariance = all.topLeftCorner(n, n);
  describe_values(solver, configured_values(vehicle), result);
  Eigen::VectorXd prior(n);
  std::copy_n(solver.prior_sigma().begin(), kCalibratedCount, prior.begin());
  result.open = open_directions(result.covariance, prior);
  result.vehicle = with_observed(vehicle, result);
  return result;
}

}  // namespace curbstone::calibrate
