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

/// One parameter, as found.
struct CalibratedValue {
  std::string name;         ///< "lidar.yaw"
  std::string unit;         ///< "m" or "rad"
  double configured = 0.0;  ///< what the vehicle's file said
  double value = 0.0;       ///< `configured` where the drive says nothing
  double sigma = 0.0;       ///< 1 standard deviation, the prior included
  double share = 0.0;       ///< 0..1 of what is known now that the drive showed: 1 - sigma^2 / prior^2
  bool observed = false;    ///< the drive showed nearly all of it, and well enough to be of use
};

/// A direction that the drive left open: a unit-free combination of parameters of which only the prior speaks.
struct OpenDirection {
  std::vector<std::pair<std::string, double>> parts;  ///< the largest ones, in units of their priors
};

struct CalibrationResult {
  std::array<CalibratedValue, kCalibratedCount> values;
  Eigen::Matrix<double, 15, 15> covariance;  ///< of the values
  std::vector<OpenDirection> open;
  VehicleConfig vehicle;             ///< the given one with what was observed put in
  int segments = 0;                  ///< pieces of the drive that were compared
  double distance = 0.0;             ///< m driven in them
  double turned = 0.0;               ///< rad, sum of the absolute turns in them
  std::array<double, 3> noise = {};  ///< found, m, rad, m/s: wheels against LiDAR; gyro against it; accelerometer

  [[nodiscard]] const CalibratedValue& operator[](Calibrated which) const {
    return values[static_cast<std::size_t>(which)];
  }
};

/// Radii, track and extrinsics for which wheels, LiDAR and IMU agree best: least squares over pieces of the drive of
/// half a second (Ceres), with a wide prior about `vehicle` so that what the drive does not tell stays where it was.
///
/// - wheels against LiDAR: hand-eye, B X = X L (Tsai and Lenz 1989), where B is the arc that the wheels rolled in the
///   plane of base_link, sideways and upwards 0;
/// - gyro against LiDAR: R_imu = Q R_lidar Q^T, with the gyro preintegrated (Forster et al. 2017, section VI);
/// - accelerometer against LiDAR: the change of the mean velocity from one piece to the next, with the direction of
///   gravity in the map, the bias and the lever arm.
///
/// Slips and other outliers are held down by a robust loss; the noise of each kind is taken from its residuals, so that
/// the covariance does not depend on anybody's guess. What was observed is read off the information matrix.
/// Throws std::runtime_error when there is not enough data to speak of.
[[nodiscard]] CalibrationResult calibrate(const CalibrationData& data, const VehicleConfig& vehicle);

}  // namespace curbstone::calibrate
