#include "tests/tools/calibrate/calibration_drive.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "tools/simulate/motion/town_motion.hpp"
#include "tools/simulate/sensors/imu_model.hpp"
#include "tools/simulate/sensors/wheel_model.hpp"

namespace curbstone::calibrate {

namespace {

constexpr std::int64_t kStart = 1'750'000'000'000'000;  // us
constexpr double kLongest = 150.0;                      // s

class StraightMotion final : public simulate::motion::Motion {
 public:
  [[nodiscard]] Pose T_world_base(double t) const override {
    const double ramp = std::max(0.0, t - 4.0);
    const double x = ramp < 4.0 ? 0.25 * ramp * ramp * (1.0 - ramp / 24.0) : 2.0 * ramp - 16.0 / 3.0;
    const double shaking = std::min(1.0, ramp / 4.0);
    Pose T = Pose::Identity();
    T.translation() << x, 0.0, 0.001 * shaking * std::sin(13.0 * t);
    T.linear() =
        rotation_from_rpy(0.002 * shaking * std::sin(8.0 * t), 0.002 * shaking * std::sin(10.0 * t + 1.0), 0.0);
    return T;
  }
};

class WindingMotion final : public simulate::motion::Motion {
 public:
  WindingMotion() {
    Eigen::Vector2d p = Eigen::Vector2d::Zero();
    double heading = 0.0;
    constexpr int kFine = 20;
    for (double t = 0.0; t < kLongest + 1.0; t += kStep) {
      knots_.push_back({p, speed(t) * Eigen::Vector2d(std::cos(heading), std::sin(heading)), heading, yaw_rate(t)});
      for (int i = 0; i < kFine; ++i) {
        const double h = kStep / kFine, middle = t + (i + 0.5) * h;
        const double toward = heading + 0.5 * h * yaw_rate(middle);
        p += h * speed(middle) * Eigen::Vector2d(std::cos(toward), std::sin(toward));
        heading += h * yaw_rate(middle);
      }
    }
  }
  [[nodiscard]] Pose T_world_base(double t) const override {
    const double at = std::max(0.0, t) / kStep;
    const auto i = static_cast<std::size_t>(at);
    const double u = at - std::floor(at);
    const Knot &a = knots_[i], &b = knots_[i + 1];
    const double h00 = (1 + 2 * u) * (1 - u) * (1 - u), h10 = u * (1 - u) * (1 - u);  // Hermite
    const double h01 = u * u * (3 - 2 * u), h11 = u * u * (u - 1);
    const Eigen::Vector2d p = h00 * a.position + h10 * kStep * a.velocity + h01 * b.position + h11 * kStep * b.velocity;
    const double heading = h00 * a.heading + h10 * kStep * a.yaw_rate + h01 * b.heading + h11 * kStep * b.yaw_rate;
    const double v = speed(t), shaking = v / 3.0;
    const double lean = 0.005 * v * yaw_rate(t);
    Pose T = Pose::Identity();
    T.translation() << p, 0.001 * shaking * std::sin(13.0 * t);
    T.linear() = rotation_from_rpy(lean + 0.0015 * shaking * std::sin(8.0 * t),
                                   0.002 * shaking * std::sin(10.0 * t + 1.0), heading);
    return T;
  }

 private:
  struct Knot {
    Eigen::Vector2d position, velocity;
    double heading, yaw_rate;
  };
  static constexpr double kStep = 0.01;  // s
  static double speed(double t) {
    const double go = std::clamp((t - 4.0) / 6.0, 0.0, 1.0);
    return 3.0 * go * go * (3.0 - 2.0 * go) * (1.0 + 0.25 * std::sin(0.4 * t));
  }
  static double yaw_rate(double t) { return 0.13 * speed(t) * std::sin(0.25 * t); }
  std::vector<Knot> knots_;
};

}  // namespace

VehicleConfig true_vehicle() {
  VehicleConfig vehicle;
  vehicle.lidar = {0.21, -0.06, 1.70, 0.010, 0.015, 0.030};
  vehicle.imu = {-0.15, 0.08, 0.45, -0.012, 0.008, -0.020};
  return vehicle;
}

VehicleConfig believed_vehicle() {
  VehicleConfig vehicle = true_vehicle();
  vehicle.wheel_radius *= 1.02;
  vehicle.track_width *= 0.95;
  const std::array wrong_lidar = {-0.08, 0.06, 0.03, -0.01, 0.01, 0.035};
  const std::array wrong_imu = {0.05, -0.04, -0.05, 0.01, -0.01, 0.0175};
  for (std::size_t i = 0; i < 6; ++i) {
    vehicle.lidar[i] += wrong_lidar[i];
    vehicle.imu[i] += wrong_imu[i];
  }
  return vehicle;
}

const simulate::motion::Motion& town_motion() {
  static const simulate::world::Town town({.seed = 1});
  static const simulate::motion::TownMotion motion(town, true_vehicle(), simulate::motion::SpeedProfile({}, kLongest));
  return motion;
}

const simulate::motion::Motion& winding_motion() {
  static const WindingMotion motion;
  return motion;
}

const simulate::motion::Motion& straight_motion() {
  static const StraightMotion motion;
  return motion;
}

CalibrationData drive_to_calibrate(const simulate::motion::Motion& motion, double seconds, std::uint64_t seed) {
  const VehicleConfig vehicle = true_vehicle();
  simulate::sensors::WheelNoise wheel_noise;
  wheel_noise.radius_error = 0.0;
  simulate::sensors::ImuModel imu({}, vehicle, motion, simulate::numerics::Random(seed).fork(11));
  simulate::sensors::WheelModel wheels(wheel_noise, vehicle, motion, seconds,
                                       simulate::numerics::Random(seed).fork(12));
  simulate::numerics::Random noise = simulate::numerics::Random(seed).fork(13);
  const auto normals = [&](double sigma) -> Eigen::Vector3d {
    return {noise.normal(sigma), noise.normal(sigma), noise.normal(sigma)};
  };
  const auto utime = [](double t) { return kStart + std::llround(t * 1e6); };
  const double radians = 2.0 * std::numbers::pi / wheel_noise.counts_per_revolution;

  CalibrationData data;
  Eigen::Vector3d standing_rate = Eigen::Vector3d::Zero();
  constexpr int kStanding = 300;  // samples: the filter's estimate of the bias
  for (int i = 1; i < static_cast<int>(100.0 * seconds); ++i) {
    const double t = 0.01 * i;
    const simulate::motion::Inertia inertia = imu.sample(t);
    data.imu.push_back({utime(t), inertia.angular_rate, inertia.specific_force});
    if (i <= kStanding) standing_rate += inertia.angular_rate / kStanding;
    const auto counts = wheels.counts(t + 0.004);
    data.wheels.push_back(
        {utime(t + 0.004), {radians * static_cast<double>(counts[0]), radians * static_cast<double>(counts[1])}});
    if (i % 5 != 3) continue;
    LidarPose pose{utime(t), motion.T_world_base(t) * vehicle.T_base_lidar()};
    pose.T_map_lidar.translation() += normals(0.003);
    pose.T_map_lidar.linear() = (pose.T_map_lidar.linear() * so3_exp(normals(3e-4)).toRotationMatrix()).eval();
    data.lidar.push_back(pose);
  }
  data.gyro_bias = standing_rate;
  return data;
}

}  // namespace curbstone::calibrate
