#include "services/ekf/filter/filter.hpp"

#include <gtest/gtest.h>

#include "tests/services/ekf/simulated_drive.hpp"

namespace curbstone::ekf::filter {
namespace {

struct Result {
  std::vector<model::Estimate> estimates;
  Counters counters;
  model::Belief belief;
};

/// Feeds a drive in the order of its stamps; `keep` says which samples the filter gets.
template <class KeepImu, class KeepWheels>
Result run(const base::EkfConfig& config, const Drive& drive, KeepImu keep_imu, KeepWheels keep_wheels) {
  Filter filter(config);
  Result result;
  std::size_t w = 0;
  for (const base::ImuSample& imu : drive.imu) {
    for (; w < drive.wheels.size() && drive.wheels[w].utime <= imu.utime; ++w)
      if (keep_wheels(drive.wheels[w])) filter.add(drive.wheels[w], result.estimates);
    if (keep_imu(imu)) filter.add(imu, result.estimates);
  }
  result.counters = filter.counters();
  result.belief = filter.belief();
  return result;
}
Result run(const base::EkfConfig& config, const Drive& drive) {
  const auto all = [](const auto&) { return true; };
  return run(config, drive, all, all);
}

/// From here: seconds since the drive began.
double seconds_in(const Drive& drive, std::int64_t utime) {
  return base::seconds_between(drive.imu.front().utime, utime);
}

struct Errors {
  double position = 0.0;  // m, largest
  double tilt = 0.0;      // rad, largest roll or pitch
  double yaw = 0.0;       // rad, largest
  double final_position = 0.0;
};

Errors errors_of(const Result& result, const Drive& drive) {
  Errors errors;
  const std::size_t start = drive.index_of(result.estimates.front().utime);
  for (const model::Estimate& e : result.estimates) {
    const Pose truth = drive.T_odom_base(drive.index_of(e.utime), start);
    errors.final_position = (e.T_odom_base.translation() - truth.translation()).norm();
    errors.position = std::max(errors.position, errors.final_position);
    const Eigen::Vector3d a = roll_pitch_yaw(e.T_odom_base.linear());
    const Eigen::Vector3d b = roll_pitch_yaw(truth.linear());
    errors.tilt = std::max({errors.tilt, std::abs(a.x() - b.x()), std::abs(a.y() - b.y())});
    errors.yaw = std::max(errors.yaw, std::abs(std::remainder(a.z() - b.z(), 2.0 * M_PI)));
  }
  return errors;
}

constexpr double kDegree = M_PI / 180.0;

DriveOptions typical() {
  DriveOptions o;
  o.gyro_bias << 0.004, -0.006, 0.008;
  o.accelerometer_bias << 0.03, -0.02, 0.04;
  o.wheel_speed_noise = 0.01;
  o.stamp_jitter = 2e-4;
  return o;
}

void print(const char* name, const Result& result, const Drive& drive) {
  const Errors e = errors_of(result, drive);
  std::printf("[ figure ] %s: %.1f m, max %.3f m (%.2f %%), end %.3f m, tilt %.3f deg, yaw %.3f deg\n", name,
              drive.distance, e.position, 100.0 * e.position / drive.distance, e.final_position, e.tilt / kDegree,
              e.yaw / kDegree);
  for (const auto& [key, value] : result.counters.values())
    std::printf("             %s %ld\n", key.c_str(), static_cast<long>(value));
}

TEST(Filter, FollowsADriveOverHillsWithinOnePercent) {
  const base::EkfConfig config;
  const Drive drive = simulate_drive(typical(), config.vehicle);
  const Result result = run(config, drive);
  print("typical", result, drive);
  const Errors errors = errors_of(result, drive);
  EXPECT_LT(errors.position, 0.01 * drive.distance);
  EXPECT_LT(errors.tilt, 0.5 * kDegree);
  EXPECT_LT(errors.yaw, 0.5 * kDegree);
}

TEST(Filter, LearnsBiasesThatAreNotConfigured) {
  base::EkfConfig config;
  config.start.accelerometer_bias_sigma = 0.1;
  DriveOptions options = typical();
  options.curves = 0.6;
  const Drive drive = simulate_drive(options, config.vehicle);
  const Result result = run(config, drive);
  const model::Estimate& last = result.estimates.back();
  EXPECT_LT((last.gyro_bias - options.gyro_bias).cwiseAbs().maxCoeff(), 0.02 * kDegree);
  EXPECT_LT((last.accelerometer_bias - options.accelerometer_bias).cwiseAbs().maxCoeff(), 0.02);
}

TEST(Filter, StartedOnTheMoveItLevelsItselfAndFindsTheGyroBias) {
  const base::EkfConfig config;
  DriveOptions options = typical();
  options.stand_first = -4.0;  // already at speed
  options.stop_at = 1e9;
  const Drive drive = simulate_drive(options, config.vehicle);
  const Result result = run(config, drive);
  print("moving start", result, drive);
  EXPECT_EQ(result.counters["starts.moving"], 1);
  const Errors errors = errors_of(result, drive);
  EXPECT_LT(errors.tilt, 2.0 * kDegree);
  EXPECT_LT((result.estimates.back().gyro_bias - options.gyro_bias).cwiseAbs().maxCoeff(), 0.1 * kDegree);
  EXPECT_LT(errors.yaw, 10.0 * kDegree);  // it never stands: the bias is only guessed at
}

TEST(Filter, StartsAnywayWhenTheImuIsNeverQuietAndNoWheelTurns) {
  const base::EkfConfig config;
  DriveOptions options = typical();
  options.seconds = 8.0;
  options.stand_first = 100.0;
  Drive drive = simulate_drive(options, config.vehicle);
  for (base::ImuSample& sample : drive.imu)  // it is rocked
    sample.angular_rate.y() += 0.05 * std::sin(9.0 * seconds_in(drive, sample.utime));
  const Result result = run(config, drive);
  ASSERT_FALSE(result.estimates.empty());
  EXPECT_EQ(result.counters["starts.impatient"], 1);
  EXPECT_NEAR(seconds_in(drive, result.estimates.front().utime), config.start.patience, 0.02);
  EXPECT_GT(result.estimates.front().pose_covariance(3, 3), 1e-4);
}

TEST(Filter, StandsStillWithoutDrift) {
  const base::EkfConfig config;
  DriveOptions options = typical();
  options.seconds = 120.0;
  options.stop_at = 1e9;
  options.stand_first = 1000.0;
  const Drive drive = simulate_drive(options, config.vehicle);
  const Result result = run(config, drive);
  const Errors errors = errors_of(result, drive);
  EXPECT_LT(errors.position, 1e-3);
  EXPECT_LT(errors.yaw, 0.001 * kDegree);
  EXPECT_TRUE(result.estimates.back().stationary);
}

TEST(Filter, OneSlippingWheelDoesNotTurnIt) {
  const base::EkfConfig config;
  DriveOptions options = typical();
  options.slip_begin = 12.0;
  options.slip_end = 14.0;
  options.slip_left = 0.4;
  const Drive drive = simulate_drive(options, config.vehicle);
  const Result result = run(config, drive);
  print("left wheel slips 40 % for 2 s", result, drive);
  const Errors errors = errors_of(result, drive);
  EXPECT_LT(errors.position, 0.01 * drive.distance);
  EXPECT_LT(errors.yaw, 0.5 * kDegree);
  EXPECT_GT(result.counters["slips.left"], 0);
}

TEST(Filter, BothWheelsSlippingDoNotCarryItAway) {
  const base::EkfConfig config;
  for (const double slip : {0.25, -1.0}) {  // spinning; locked
    DriveOptions options = typical();
    options.slip_begin = 12.0;
    options.slip_end = 14.0;
    options.slip_left = options.slip_right = slip;
    const Drive drive = simulate_drive(options, config.vehicle);
    const Result result = run(config, drive);
    print(slip > 0 ? "both slip 25 % for 2 s" : "both locked for 2 s", result, drive);
    const Errors errors = errors_of(result, drive);
    EXPECT_LT(errors.position, 0.01 * drive.distance);  // wheels alone: 1.5 m and 6 m
    EXPECT_LT(errors.tilt, 0.5 * kDegree);
    for (const model::Estimate& e : result.estimates) {
      const double t = seconds_in(drive, e.utime);
      EXPECT_FALSE(e.stationary && t > 5.0 && t < 26.0) << "at " << t;
      EXPECT_TRUE(e.slipping || t < 12.2 || t > 13.9) << "at " << t;
    }
  }
}

TEST(Filter, ADriveWithoutSlipShowsNone) {
  const base::EkfConfig config;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    DriveOptions options = typical();
    options.seed = seed;
    const Drive drive = simulate_drive(options, config.vehicle);
    const Result result = run(config, drive);
    EXPECT_LE(result.counters["slips.left"] + result.counters["slips.right"], 2) << "seed " << seed;
  }
}

TEST(Filter, CoastsOnTheWheelsWithoutImuAndRecovers) {
  const base::EkfConfig config;
  const DriveOptions options = typical();
  const Drive drive = simulate_drive(options, config.vehicle);
  const auto lost = [&](const auto& s) { return std::abs(seconds_in(drive, s.utime) - 20.0) < 5.0; };
  const Result result = run(
      config, drive, [&](const base::ImuSample& s) { return !lost(s); }, [](const base::WheelSample&) { return true; });
  print("no IMU for 10 s", result, drive);
  int coasting = 0;
  for (const model::Estimate& e : result.estimates) {
    const double t = seconds_in(drive, e.utime);
    coasting += e.no_imu ? 1 : 0;
    EXPECT_EQ(e.no_imu, t > 15.1 && t < 25.0) << "at " << t;
  }
  EXPECT_NEAR(coasting, 990, 15);  // at the wheels' rate
  EXPECT_LT(errors_of(result, drive).final_position, 0.02 * drive.distance);
}

TEST(Filter, CoastsOnTheImuWithoutWheelsWithAGrowingCovarianceAndRecovers) {
  const base::EkfConfig config;
  const Drive drive = simulate_drive(typical(), config.vehicle);
  const auto lost = [&](const auto& s) { return std::abs(seconds_in(drive, s.utime) - 20.0) < 5.0; };
  const Result result = run(
      config, drive, [](const base::ImuSample&) { return true; }, [&](const base::WheelSample& s) { return !lost(s); });
  print("no wheels for 10 s", result, drive);
  double before = 0.0;
  double after = 0.0;
  for (const model::Estimate& e : result.estimates) {
    const double t = seconds_in(drive, e.utime);
    EXPECT_EQ(e.no_wheels, t > 15.195 && t < 25.005) << "at " << t;
    if (t < 15.0) before = e.twist_covariance(0, 0);
    if (t < 25.0) after = e.twist_covariance(0, 0);
  }
  EXPECT_GT(after, 10.0 * before);
  EXPECT_LT(result.estimates.back().twist_covariance(0, 0), 2.0 * before);
  EXPECT_LT(errors_of(result, drive).final_position, 0.03 * drive.distance);
}

TEST(Filter, OdomDoesNotJumpWithTheClock) {
  const base::EkfConfig config;
  Drive drive = simulate_drive(typical(), config.vehicle);
  for (const std::int64_t jump : {5'000'000LL, -3'600'000'000LL}) {
    Drive jumped = drive;
    const std::int64_t when = drive.imu.front().utime + 15'000'000;
    for (auto& s : jumped.imu) s.utime += s.utime > when ? jump : 0;
    for (auto& s : jumped.wheels) s.utime += s.utime > when ? jump : 0;
    Filter filter(config);
    std::vector<model::Estimate> out;
    for (std::size_t i = 0; i < jumped.imu.size(); ++i) {
      filter.add(jumped.wheels[i], out);
      filter.add(jumped.imu[i], out);
    }
    EXPECT_GE(filter.counters()["reset.clock"], 1);
    double largest = 0.0;
    for (std::size_t i = 1; i < out.size(); ++i)
      largest = std::max(largest, (out[i].T_odom_base.translation() - out[i - 1].T_odom_base.translation()).norm());
    EXPECT_LT(largest, 0.15);
    EXPECT_NEAR(out.back().velocity.x(), drive.truth.back().velocity.x(), 0.1);
  }
}

TEST(Filter, SurvivesACounterThatRestarts) {
  const base::EkfConfig config;
  Drive drive = simulate_drive(typical(), config.vehicle);
  for (base::WheelSample& s : drive.wheels)
    if (seconds_in(drive, s.utime) > 20.0) s.angle = {s.angle[0] - 1000.0, s.angle[1] - 1000.0};
  const Result result = run(config, drive);
  EXPECT_EQ(result.counters["refused.wheel_jump"], 1);
  EXPECT_LT(errors_of(result, drive).position, 0.01 * drive.distance);
}

TEST(Filter, MissingImuSamplesCostLittle) {
  const base::EkfConfig config;
  const Drive drive = simulate_drive(typical(), config.vehicle);
  int i = 0;
  const Result result = run(
      config, drive, [&](const base::ImuSample&) { return ++i % 50 > 4; },
      [](const base::WheelSample&) { return true; });
  EXPECT_LT(errors_of(result, drive).position, 0.01 * drive.distance);
  EXPECT_LT(errors_of(result, drive).tilt, 0.5 * kDegree);
}

}  // namespace
}  // namespace curbstone::ekf::filter
