#include <gtest/gtest.h>

#include <array>

#include "common/linear/decompositions.hpp"
#include "tests/services/ekf/drawn_drives.hpp"
#include "tests/services/ekf/town_drive.hpp"

namespace curbstone::ekf::filter {
namespace {

// Is the covariance honest? Over many drives, whose errors are drawn from the very distributions that the filter is
// configured with, the normalised estimation error squared e^T P^-1 e of n quantities is chi-square with n degrees of
// freedom (Bar-Shalom, Estimation with Applications to Tracking and Navigation, 5.4).

constexpr double kLook[] = {8.0, 16.0, 24.0, 34.0, 45.0};  // s; at 34 it has just stood

double velocity_nees(const model::Estimate& e, const Drive& drive) {
  const Eigen::Vector3d error = drive.truth[drive.index_of(e.utime)].velocity - e.velocity;
  return error.dot(Ldlt<3>(e.twist_covariance.topLeftCorner<3, 3>()).solve(error));
}

double bias_nees(const model::Estimate& e, const model::Belief& belief, const Drive& drive) {
  const TruePose& truth = drive.truth[drive.index_of(e.utime)];
  Eigen::Matrix<double, 6, 1> error;
  error << truth.gyro_bias - e.gyro_bias, truth.accelerometer_bias - e.accelerometer_bias;
  const Eigen::Matrix<double, 6, 6> covariance = belief.covariance.block<6, 6>(model::kGyroBias, model::kGyroBias);
  return error.dot(Ldlt<6>(covariance).solve(error));
}

constexpr double kLow3 = 99.4 / kRuns, kHigh3 = 213.0 / kRuns;

TEST(Consistency, ErrorsAreAsLargeAsTheCovarianceSays) {
  const base::EkfConfig config = true_config();
  std::array<double, std::size(kLook)> pose = {}, biases = {};
  for (unsigned run = 0; run < kRuns; ++run) {
    const Drive drive = simulate_drive(drawn(config, run), config.vehicle);
    Filter filter(config);
    run_and_look(filter, drive, kLook, [&](std::size_t k, const model::Estimate& e, std::size_t start) {
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
  const base::EkfConfig config;
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
    run_and_look(filter, drive, kTimes, [&](std::size_t k, const model::Estimate& e, std::size_t start) {
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
  const base::EkfConfig config;
  double mean = 0.0;
  double worst = 0.0;
  constexpr unsigned kDrives = 10;
  for (unsigned k = 0; k < kDrives; ++k) {
    TownDriveOptions options;
    options.seed = 2000 + k;
    const Drive drive = simulate_town_drive(options, config.vehicle);
    Filter filter(config);
    const double error = end_error(run(filter, drive), drive);
    EXPECT_GT(filter.counters()["slips.left"] + filter.counters()["slips.right"], 0);
    mean += error / kDrives;
    worst = std::max(worst, error);
  }
  std::printf("[ figure ] town with slips, end error: mean %.2f %%, worst %.2f %% of 130 m\n", 100.0 * mean,
              100.0 * worst);
  EXPECT_LT(worst, 0.01);
}

TEST(Consistency, ABaseLinkThatIsNotOverTheAxleIsFoundOut) {
  // KITTI's car with base_link below the LiDAR, and the filter does not know: bends would throw it out sideways.
  const base::EkfConfig config;
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
}  // namespace curbstone::ekf::filter
