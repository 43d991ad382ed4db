#include "tests/services/ekf/drawn_drives.hpp"

#include <random>

#include "common/linear/decompositions.hpp"

namespace curbstone::ekf {

base::EkfConfig true_config() {
  base::EkfConfig config;
  config.noise.gyro = 3e-4;
  config.noise.accelerometer = 3e-3;
  config.noise.gyro_bias_walk = 2e-5;
  config.noise.accelerometer_bias_walk = 2e-4;
  config.noise.wheel_scale_walk = 1e-7;
  config.wheels.speed_noise = 0.02;
  config.wheels.slip_noise = 0.0;
  config.wheels.stamp_noise = 0.0;
  config.wheels.angle_noise = 1e-4;
  config.wheels.lateral_noise = 0.003;  // the simulated axle does not slide at all
  config.wheels.axle_sigma = 0.0;
  config.wheels.course_sigma = 0.0;
  config.wheels.vertical_noise = 0.003;
  return config;
}

DriveOptions drawn(const base::EkfConfig& config, unsigned seed) {
  std::mt19937_64 random(1000 + seed);
  std::normal_distribution<double> normal;
  const auto vector = [&](double sigma) -> Eigen::Vector3d {
    return {sigma * normal(random), sigma * normal(random), sigma * normal(random)};
  };
  DriveOptions o;
  o.seed = seed;
  o.seconds = 46.0;
  o.stop_at = 29.0;
  o.gyro_noise = config.noise.gyro;
  o.accelerometer_noise = config.noise.accelerometer;
  o.gyro_bias_walk = config.noise.gyro_bias_walk;
  o.accelerometer_bias_walk = config.noise.accelerometer_bias_walk;
  o.gyro_bias = vector(config.start.gyro_bias_sigma);
  o.accelerometer_bias = vector(config.start.accelerometer_bias_sigma);
  const double common = config.wheels.scale_sigma * normal(random);
  o.wheel_scale << common + config.wheels.mismatch_sigma * normal(random),
      common + config.wheels.mismatch_sigma * normal(random), config.wheels.track_sigma * normal(random);
  o.wheel_noise_interval = 0.01;  // white, as the filter is configured: sigma over its intervals
  o.wheel_speed_noise = config.wheels.speed_noise * std::sqrt(config.wheels.interval / o.wheel_noise_interval);
  o.counts_per_turn = 65536.0;
  return o;
}

DriveOptions drawn_uncalibrated(std::mt19937& random) {
  const auto between = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
  DriveOptions o;
  o.speed = between(2.0, 8.0);
  o.curves = between(0.05, 0.8);
  o.hills = between(0.0, 0.2);
  o.gyro_bias.setConstant(between(-0.03, 0.03));
  o.accelerometer_bias.setConstant(between(-0.3, 0.3));
  o.wheel_scale << between(-0.1, 0.1), between(-0.1, 0.1), between(-0.3, 0.3);
  return o;
}

double pose_nees(const model::Estimate& e, const Drive& drive, std::size_t start) {
  const Pose truth = drive.T_odom_base(drive.index_of(e.utime), start);
  Eigen::Matrix<double, 6, 1> error;
  error << truth.translation() - e.T_odom_base.translation(),
      so3_log(Eigen::Quaterniond(e.T_odom_base.linear().transpose() * truth.linear()));
  return error.dot(Ldlt<6>(e.pose_covariance).solve(error));
}

std::vector<model::Estimate> run(filter::Filter& filter, const Drive& drive) {
  constexpr double kNever[] = {1e9};
  return run_and_look(filter, drive, kNever, [](auto&&...) {});
}

double end_error(const std::vector<model::Estimate>& estimates, const Drive& drive) {
  const std::size_t start = drive.index_of(estimates.front().utime);
  const Pose truth = drive.T_odom_base(drive.index_of(estimates.back().utime), start);
  return (truth.translation() - estimates.back().T_odom_base.translation()).norm() / drive.distance;
}

}  // namespace curbstone::ekf
