#include "tools/simulate/sensors/imu_model.hpp"

#include <algorithm>
#include <cmath>

namespace curbstone::simulate::sensors {

ImuModel::ImuModel(const ImuNoise& noise, const VehicleConfig& vehicle, const motion::Motion& motion,
                   numerics::Random random)
    : noise_(noise),
      T_base_imu_(vehicle.T_base_imu()),
      motion_(motion),
      random_(random),
      gyro_bias_(normals(noise.gyro_bias)),
      accelerometer_bias_(normals(noise.accelerometer_bias)) {}

motion::Inertia ImuModel::sample(double t) {
  const double elapsed = std::sqrt(std::max(0.0, t - last_t_));
  last_t_ = t;
  gyro_bias_ += normals(noise_.gyro_walk * elapsed);
  accelerometer_bias_ += normals(noise_.accelerometer_walk * elapsed);
  motion::Inertia inertia = motion::inertia_at(motion_, T_base_imu_, t);
  const double speed = std::abs(motion::rolled_distance(motion_, Eigen::Vector3d::Zero(), t - 0.005, t + 0.005)) / 0.01;
  const double shaking = noise_.vibration * std::min(1.5, speed / 3.0);
  inertia.angular_rate += gyro_bias_ + normals(noise_.gyro_sigma);
  inertia.specific_force += accelerometer_bias_ + normals(std::hypot(noise_.accelerometer_sigma, shaking));
  return inertia;
}

std::array<double, 4> ImuModel::orientation(double t) const {
  const Eigen::Matrix3d R_world_imu = (motion_.T_world_base(t) * T_base_imu_).linear();
  const Eigen::Quaterniond q(rotation_from_rpy(0.004, -0.003, 1.1) * R_world_imu);
  return {q.w(), q.x(), q.y(), q.z()};
}

}  // namespace curbstone::simulate::sensors
