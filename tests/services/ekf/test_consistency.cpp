#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "services/ekf/filter.hpp"
#include "tests/services/ekf/simulated_drive.hpp"

namespace curbstone {
namespace {

// Is the covariance honest? Over many drives, whose errors are drawn from the very distributions that the filter is
// told of, the normalised estimation error squared e^T P^-1 e of n quantities is chi-square with n degrees of freedom
// (Bar-Shalom, Estimation with Applications to Tracking and Navigation, 5.4).

constexpr int kRuns = 50;
constexpr double kLook[] = {8.0, 16.0, 24.0, 34.0, 45.0};  // s; at 34 it has just stood

EkfConfig told() {
  EkfConfig config;
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
  config.wheels.lateral_lever = 0.0;
  config.wheels.vertical_noise = 0.003;
  return config;
}

DriveOptions drawn(const EkfConfig& config, unsigned seed) {
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
  o.wheel_noise_interval = 0.01;  // white, as the filter is told: sigma over its intervals
  o.wheel_speed_noise = config.wheels.speed_noise * std::sqrt(config.wheels.interval / o.wheel_noise_interval);
  o.counts_per_turn = 65536.0;
  return o;
}

struct Nees {
  double pose = 0.0;   // 6
  double twist = 0.0;  // velocity: 3
  double bias = 0.0;   // both: 6
};

Nees nees(const Estimate& e, const Belief& belief, const Drive& drive, std::size_t start, const DriveOptions&) {
  const std::size_t index = drive.index_of(e.utime);
  const Pose truth = drive.T_odom_base(index, start);
  Eigen::Matrix<double, 6, 1> pose;
  pose << truth.translation() - e.T_odom_base.translation(),
      so3_log(Eigen::Quaterniond(e.T_odom_base.linear().transpose() * truth.linear()));
  Eigen::Matrix<double, 6, 1> bias;
  bias << drive.truth[index].gyro_bias - e.gyro_bias, drive.truth[index].accelerometer_bias - e.accelerometer_bias;
  const Eigen::Matrix<double, 6, 6> bias_covariance = belief.covariance.block<6, 6>(kGyroBias, kGyroBias);

  return {pose.dot(e.pose_covariance.ldlt().solve(pose)), 0.0, bias.dot(bias_covariance.ldlt().solve(bias))};
}

TEST(Consistency, ErrorsAreAsLargeAsTheCovarianceSays) {
  const EkfConfig config = told();
  std::vector<Nees> mean(std::size(kLook));
  for (unsigned run = 0; run < kRuns; ++run) {
    const DriveOptions options = drawn(config, run);
    const Drive drive = simulate_drive(options, config.vehicle);
    Filter filter(config);
    std::vector<Estimate> out;
    std::optional<std::size_t> start;
    std::size_t look = 0;
    for (std::size_t i = 0; i < drive.imu.size() && look < std::size(kLook); ++i) {
      filter.add(drive.wheels[i], out);
      filter.add(drive.imu[i], out);
      if (!start && !out.empty()) start = i;
      if (seconds_between(drive.imu.front().utime, drive.imu[i].utime) < kLook[look]) continue;
      const Nees now = nees(out.back(), filter.belief(), drive, *start, options);
      mean[look].pose += now.pose / kRuns;
      mean[look].bias += now.bias / kRuns;
      ++look;
    }
  }
  for (std::size_t i = 0; i < std::size(kLook); ++i) {
    std::printf("[ figure ] NEES at %.0f s: pose %.2f, biases %.2f (expected 6)\n", kLook[i], mean[i].pose,
                mean[i].bias);
  }
  // 50 runs of 6: chi-square with 300 degrees of freedom, 99.9 % two-sided, over 50
  constexpr double kLow = 226.0 / kRuns;
  constexpr double kHigh = 387.0 / kRuns;
  for (const Nees& m : mean) {
    EXPECT_GT(m.pose, kLow);
    EXPECT_LT(m.pose, kHigh);
    EXPECT_GT(m.bias, kLow);
    EXPECT_LT(m.bias, kHigh);
  }
}

}  // namespace
}  // namespace curbstone
