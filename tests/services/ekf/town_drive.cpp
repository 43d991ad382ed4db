#include "tests/services/ekf/town_drive.hpp"

#include <cmath>
#include <map>
#include <numbers>

#include "tools/simulate/motion/town_motion.hpp"
#include "tools/simulate/sensors/imu_model.hpp"
#include "tools/simulate/sensors/wheel_model.hpp"

namespace curbstone::ekf {

namespace {

constexpr std::int64_t kSetOff = 1'750'000'000'000'000;  // us
constexpr double kSampling = 0.01;                       // s, of both sensors
constexpr double kAfterImu = 0.004;                      // s, wheels after IMU

/// The town's motion is the axle's; base_link is elsewhere along the vehicle, and looks a little elsewhere.
class ShiftedMotion final : public simulate::motion::Motion {
 public:
  ShiftedMotion(const simulate::motion::Motion& axle, const TownDriveOptions& o)
      : axle_(axle), T_axle_base_(Pose::Identity()) {
    // The axle's x, seen from base_link, is (1, c0, c1).
    const Eigen::Matrix3d R_base_axle = rotation_from_rpy(0, -o.course[1], o.course[0]);
    T_axle_base_.linear() = R_base_axle.transpose();
    T_axle_base_.translation() = R_base_axle.transpose() * Eigen::Vector3d(-o.axle, 0, 0);
  }
  [[nodiscard]] Pose T_world_base(double t) const override { return axle_.T_world_base(t) * T_axle_base_; }

 private:
  const simulate::motion::Motion& axle_;
  Pose T_axle_base_;
};

const simulate::world::Town& town_number(unsigned number) {
  static std::map<unsigned, simulate::world::Town> towns;
  return towns.try_emplace(number, simulate::world::TownOptions{.seed = number}).first->second;
}

}  // namespace

Drive simulate_town_drive(const TownDriveOptions& o, const VehicleConfig& vehicle) {
  const simulate::motion::TownMotion of_axle(town_number(o.town), vehicle,
                                             simulate::motion::SpeedProfile({.speed = o.speed}, o.seconds));
  const ShiftedMotion motion(of_axle, o);
  simulate::sensors::ImuNoise imu_noise;
  imu_noise.gyro_sigma = o.gyro_noise;
  imu_noise.vibration = o.vibration;
  simulate::sensors::WheelNoise wheel_noise;
  if (!o.slip) wheel_noise.slips_per_minute = 0;
  VehicleConfig true_vehicle = vehicle;
  true_vehicle.wheel_radius *= 1.0 + o.scale;
  true_vehicle.track_width *= 1.0 + o.track;
  simulate::sensors::ImuModel imu(imu_noise, true_vehicle, motion, simulate::numerics::Random(o.seed).fork(11));
  simulate::sensors::WheelModel wheels(wheel_noise, true_vehicle, motion, o.seconds,
                                       simulate::numerics::Random(o.seed).fork(12));

  Drive drive;
  const auto utime = [](double t) { return kSetOff + std::llround(t * 1e6); };
  const double radians = 2.0 * std::numbers::pi / wheel_noise.counts_per_revolution;
  const int parts = o.imu_rate / 100;
  for (double t = kSampling; t < o.seconds; t += kSampling) {
    for (int part = parts - 1; part >= 0; --part) {
      const double at = t - part * kSampling / parts;
      const simulate::motion::Inertia inertia = imu.sample(at);
      drive.imu.push_back({utime(at), inertia.angular_rate, inertia.specific_force});
    }
    const auto counts = wheels.counts(t + kAfterImu);
    drive.wheels.push_back(
        {utime(t + kAfterImu), {radians * static_cast<double>(counts[0]), radians * static_cast<double>(counts[1])}});
    const Pose T_world_base = motion.T_world_base(t);
    const Eigen::Vector3d travel =
        motion.T_world_base(t + 1e-3).translation() - motion.T_world_base(t - 1e-3).translation();
    if (!drive.truth.empty())
      drive.distance += (T_world_base.translation() - drive.truth.back().T_world_base.translation()).norm();
    TruePose truth;
    truth.utime = utime(t);
    truth.T_world_base = T_world_base;
    truth.velocity = T_world_base.linear().transpose() * travel / 2e-3;
    drive.truth.push_back(truth);
  }
  return drive;
}

}  // namespace curbstone::ekf
