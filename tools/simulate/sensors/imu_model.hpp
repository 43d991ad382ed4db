#pragma once

#include <array>

#include "common/config/config.hpp"
#include "common/config/vehicle.hpp"
#include "tools/simulate/motion/motion.hpp"
#include "tools/simulate/numerics/random.hpp"

namespace curbstone::simulate::sensors {

/// A MEMS IMU of the MTi class at 100 Hz: white noise, a turn-on bias, and its slow random walk.
struct ImuNoise {
  double gyro_sigma = 0.0012;          ///< rad/s, of one sample
  double accelerometer_sigma = 0.012;  ///< m/s^2, of one sample
  double gyro_bias = 0.003;            ///< rad/s, 1 sigma
  double accelerometer_bias = 0.03;    ///< m/s^2, 1 sigma
  double gyro_walk = 2e-5;             ///< rad/s per sqrt(s)
  double accelerometer_walk = 2e-4;    ///< m/s^2 per sqrt(s)
  double vibration = 0.12;             ///< m/s^2, while rolling at 3 m/s

  void visit(ConfigVisitor& v) {
    v.field("gyro_sigma", gyro_sigma, {0.0, 1.0}, "rad/s, white noise of one sample");
    v.field("accelerometer_sigma", accelerometer_sigma, {0.0, 10.0}, "m/s^2, white noise of one sample");
    v.field("gyro_bias", gyro_bias, {0.0, 1.0}, "rad/s, 1 sigma of the bias at switching on");
    v.field("accelerometer_bias", accelerometer_bias, {0.0, 5.0}, "m/s^2, 1 sigma of the bias at switching on");
    v.field("gyro_walk", gyro_walk, {0.0, 1.0}, "rad/s per sqrt(s), random walk of the bias");
    v.field("accelerometer_walk", accelerometer_walk, {0.0, 1.0}, "m/s^2 per sqrt(s), random walk of the bias");
    v.field("vibration", vibration, {0.0, 20.0}, "m/s^2, 1 sigma, while rolling at 3 m/s");
  }
};

/// Samples in time order, each with its own noise.
class ImuModel {
 public:
  ImuModel(const ImuNoise& noise, const VehicleConfig& vehicle, const motion::Motion& motion, numerics::Random random);
  [[nodiscard]] motion::Inertia sample(double t);
  /// The device's own orientation estimate: correct in roll and pitch, arbitrary heading. w x y z.
  [[nodiscard]] std::array<double, 4> orientation(double t) const;

 private:
  Eigen::Vector3d normals(double sigma) {
    return {random_.normal(sigma), random_.normal(sigma), random_.normal(sigma)};
  }

  ImuNoise noise_;
  Pose T_base_imu_;
  const motion::Motion& motion_;
  numerics::Random random_;
  Eigen::Vector3d gyro_bias_, accelerometer_bias_;
  double last_t_ = 0;
};

}  // namespace curbstone::simulate::sensors
