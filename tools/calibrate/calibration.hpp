#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "common/config/vehicle.hpp"
#include "tools/calibrate/calibrated.hpp"
#include "tools/calibrate/calibration_data.hpp"

namespace curbstone::calibrate {

/// The result for one parameter.
struct CalibratedValue {
  std::string name;         ///< "lidar.yaw"
  std::string unit;         ///< "m" or "rad"
  double configured = 0.0;  ///< from the vehicle's file
  double value = 0.0;       ///< `configured` if the drive does not observe it
  double sigma = 0.0;       ///< 1 standard deviation, including the prior
  double share = 0.0;       ///< 0..1, share of the information from the drive: 1 - sigma^2 / prior^2
  bool observed = false;    ///< nearly all information is from the drive, and sigma is small enough to be useful
};

/// A direction that the drive does not observe: a unit-free combination of parameters constrained by the prior only.
struct OpenDirection {
  std::vector<std::pair<std::string, double>> parts;  ///< the largest ones, in units of their priors
};

struct CalibrationResult {
  std::array<CalibratedValue, kCalibratedCount> values;
  Eigen::Matrix<double, 15, 15> covariance;  ///< of the values
  std::vector<OpenDirection> open;
  VehicleConfig vehicle;             ///< the given one with the observed parameters replaced
  int segments = 0;                  ///< pieces of the drive that were used
  double distance = 0.0;             ///< m driven in them
  double turned = 0.0;               ///< rad, sum of the absolute turns in them
  std::array<double, 3> noise = {};  ///< estimated, m, rad, m/s: wheels and gyro against LiDAR; accelerometer

  [[nodiscard]] const CalibratedValue& operator[](Calibrated which) const {
    return values[static_cast<std::size_t>(which)];
  }
};

/// Estimates the radii, track and extrinsics for which wheels, LiDAR and IMU agree best: least squares over pieces of
/// the drive of half a second (Ceres), with a wide prior around `vehicle` so that parameters the drive does not observe
/// keep their value.
///
/// - wheels against LiDAR: hand-eye calibration, B X = X L (Tsai and Lenz 1989), where B is the arc that the wheels
///   rolled in the plane of base_link, lateral and vertical motion 0;
/// - gyro against LiDAR: R_imu = Q R_lidar Q^T, with the gyro preintegrated (Forster et al. 2017, section VI);
/// - accelerometer against LiDAR: the change of the mean velocity from one piece to the next, with the direction of
///   gravity in the map, the bias and the lever arm.
///
/// A robust loss suppresses slips and other outliers. The noise of each kind is estimated from its residuals, so that
/// the covariance does not depend on assumed values. Observability is determined from the information matrix. Throws
/// std::runtime_error if there is not enough data.
[[nodiscard]] CalibrationResult calibrate(const CalibrationData& data, const VehicleConfig& vehicle);

}  // namespace curbstone::calibrate
