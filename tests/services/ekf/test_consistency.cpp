#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <array>

#include "services/ekf/filter.hpp"
#include "tests/services/ekf/town_drive.hpp"

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
  config.wheels.axle_sigma = 0.0;
  config.wheels.course_sigma = 0.0;
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

double pose_nees(const Estimate& e, const Drive& drive, std::size_t start) {
  const Pose truth = drive.T_odom_base(drive.index_of(e.utime), start);
  Eigen::Matrix<double, 6, 1> error;
  error << truth.translation() - e.T_odom_base.translation(),
      so3_log(Eigen::Quaterniond(e.T_odom_base.linear().transpose() * truth.linear()));
  return error.dot(e.pose_covariance.ldlt().solve(error));
}

double velocity_nees(const Estimate& e, const Drive& drive) {
  const Eigen::Vector3d error = drive.truth[drive.index_of(e.utime)].velocity - e.velocity;
  return error.dot(e.twist_covariance.topLeftCorner<3, 3>().ldlt().solve(error));
}

double bias_nees(const Estimate& e, const Belief& belief, const Drive& drive) {
  const TruePose& truth = drive.truth[drive.index_of(e.utime)];
  Eigen::Matrix<double, 6, 1> error;
  error << truth.gyro_bias - e.gyro_bias, truth.accelerometer_bias - e.accelerometer_bias;
  const Eigen::Matrix<double, 6, 6> covariance = belief.covariance.block<6, 6>(kGyroBias, kGyroBias);
  return error.dot(covariance.ldlt().solve(error));
}

/// Runs the filter over the drive; `look(k, filter, estimate, start)` at each of the times.
template <std::size_t N, class Look>
std::vector<Estimate> run_and_look(Filter& filter, const Drive& drive, const double (&times)[N], Look look) {
  std::vector<Estimate> out;
  std::size_t start = 0;
  std::size_t k = 0;
  std::size_t w = 0;
  for (std::size_t i = 0; i < drive.imu.size(); ++i) {
    for (; w < drive.wheels.size() && drive.wheels[w].utime <= drive.imu[i].utime; ++w)
      filter.add(drive.wheels[w], out);
    const bool first = out.empty();
    filter.add(drive.imu[i], out);
    if (first) start = i;
    if (k == N || seconds_between(drive.imu.front().utime, drive.imu[i].utime) < times[k]) continue;
    look(k++, out.back(), start);
  }
  return out;
}

// 50 runs of n: chi-square with 50 n degrees of freedom, 99.9 % two-sided, over 50.
constexpr double kLow3 = 99.4 / kRuns, kHigh3 = 213.0 / kRuns;
constexpr double kLow6 = 226.0 / kRuns, kHigh6 = 387.0 / kRuns;

TEST(Consistency, ErrorsAreAsLargeAsTheCovarianceSays) {
  const EkfConfig config = told();
  std::array<double, std::size(kLook)> pose = {}, biases = {};
  for (unsigned run = 0; run < kRuns; ++run) {
    const Drive drive = simulate_drive(drawn(config, run), config.vehicle);
    Filter filter(config);
    run_and_look(filter, drive, kLook, [&](std::size_t k, const Estimate& e, std::size_t start) {
      pose[k] += pose_nees(e, drive, start) / kRuns;
      biases[k] += bias_nees(e, filter.belief(), drive) / kRuns;
    });
  }
  for (std::size_t k = 0; k < std::size(kLook); ++k) {
    std::printf("[ figure ] NEES at %.0f s: pose %.2f, biases %.2f (expected 6)\n", kLook[k], pose[k], biases[k]);
    EXPECT_GT(pose[k], kLow6);
    EXPECT_LT(pose[k], kHigh6);
    EXPECT_GT(biases[k], kLow6);
    EXPECT_LT(biases[k], kHigh6);
  }
}

// The same as one gets it: the default configuration, the simulator's own sensors with their slips, and a vehicle whose
// wheels, track and axle have been measured as badly as the configuration says.
TEST(Consistency, TheDefaultsAreHonestAboutTheSimulatorsVehicle) {
  constexpr double kTimes[] = {10.0, 20.0, 30.0, 40.0, 50.0, 59.0};
  const EkfConfig config;
  std::array<double, std::size(kTimes)> pose = {}, velocity = {};
  for (unsigned run = 0; run < kRuns; ++run) {
    std::mt19937_64 random(7000 + run);
    std::normal_distribution<double> normal;
    TownDriveOptions options;
    options.seed = 1000 + run;
    options.scale = config.wheels.scale_sigma * normal(random);
    options.track = config.wheels.track_sigma * normal(random);
    options.axle = config.wheels.axle + config.wheels.axle_sigma * normal(random);
    for (double& c : options.course) c = config.wheels.course_sigma * normal(random);
    const Drive drive = simulate_town_drive(options, config.vehicle);
    Filter filter(config);
    run_and_look(filter, drive, kTimes, [&](std::size_t k, const Estimate& e, std::size_t start) {
      pose[k] += pose_nees(e, drive, start) / kRuns;
      velocity[k] += velocity_nees(e, drive) / kRuns;
    });
  }
  for (std::size_t k = 0; k < std::size(kTimes); ++k) {
    std::printf("[ figure ] town, NEES at %.0f s: pose %.2f (expected 6), velocity %.2f (3)\n", kTimes[k], pose[k],
                velocity[k]);
    EXPECT_GT(pose[k], kLow6);
    EXPECT_LT(pose[k], kHigh6);
    EXPECT_LT(velocity[k], kHigh3);
    if (kTimes[k] != 40.0) {  // it is just starting from a stop: the simulated one stands stiller than is promised
      EXPECT_GT(velocity[k], kLow3);
    }
  }
}

TEST(Consistency, WheelsAndImuAloneStayWithinOnePercentInTheTownWithSlips) {
  const EkfConfig config;
  double mean = 0.0;
  double worst = 0.0;
  constexpr unsigned kDrives = 10;
  for (unsigned run = 0; run < kDrives; ++run) {
    TownDriveOptions options;
    options.seed = 2000 + run;
    const Drive drive = simulate_town_drive(options, config.vehicle);
    Filter filter(config);
    constexpr double kNever[] = {1e9};
    const auto out = run_and_look(filter, drive, kNever, [](auto&&...) {});
    const std::size_t start = drive.index_of(out.front().utime);
    EXPECT_GT(filter.counters()["slips.left"] + filter.counters()["slips.right"], 0);
    const Pose truth = drive.T_odom_base(drive.index_of(out.back().utime), start);
    const double error = (truth.translation() - out.back().T_odom_base.translation()).norm() / drive.distance;
    mean += error / kDrives;
    worst = std::max(worst, error);
  }
  std::printf("[ figure ] town with slips, end error: mean %.2f %%, worst %.2f %% of 130 m\n", 100.0 * mean,
              100.0 * worst);
  EXPECT_LT(worst, 0.01);
}

TEST(Consistency, ABaseLinkThatIsNotOverTheAxleIsFoundOut) {
  // KITTI's car with base_link below the LiDAR, and nobody told the filter: bends would throw it out sideways.
  const EkfConfig config;
  TownDriveOptions options;
  options.axle = -0.76;
  const Drive drive = simulate_town_drive(options, config.vehicle);
  constexpr double kNever[] = {1e9};
  Filter filter(config);
  const auto out = run_and_look(filter, drive, kNever, [](auto&&...) {});
  EXPECT_NEAR(filter.belief().mean.axle, -0.76, 0.2);  // the block has left bends only
  const Pose truth = drive.T_odom_base(drive.index_of(out.back().utime), drive.index_of(out.front().utime));
  EXPECT_LT((truth.translation() - out.back().T_odom_base.translation()).norm(), 0.01 * drive.distance);
}

}  // namespace
}  // namespace curbstone
