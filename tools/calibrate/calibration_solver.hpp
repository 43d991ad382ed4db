#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "common/config/vehicle.hpp"
#include "tools/calibrate/calibrated.hpp"
#include "tools/calibrate/calibration_noise.hpp"
#include "tools/calibrate/segment.hpp"

namespace curbstone::calibrate {

/// The least-squares problem of a drive: the residuals of calibration_residuals.hpp over all its pieces, Cauchy's loss,
/// and a wide prior around the configuration. One thread.
class CalibrationSolver {
 public:
  /// Keeps a reference to the segments.
  CalibrationSolver(const std::vector<CalibrationSegment>& segments, const VehicleConfig& vehicle);
  ~CalibrationSolver();
  CalibrationSolver(const CalibrationSolver&) = delete;
  CalibrationSolver& operator=(const CalibrationSolver&) = delete;

  /// Solves, estimates the noise from the residuals, and solves again. Throws std::runtime_error if nothing fits.
  void solve();

  /// The estimates, in the order of Calibrated.
  [[nodiscard]] std::array<double, kCalibratedCount> values() const;
  /// J^T J of all residuals, including priors and the weights of the robust loss. The parameters of Calibrated come
  /// first, then the biases and the map's level.
  [[nodiscard]] Eigen::MatrixXd information() const;
  /// 1 sigma of the priors of the parameters of Calibrated.
  [[nodiscard]] std::array<double, kCalibratedCount> prior_sigma() const;
  [[nodiscard]] const NoiseLevels& noise() const;

 private:
  class Problem;
  std::unique_ptr<Problem> problem_;
};

}  // namespace curbstone::calibrate
