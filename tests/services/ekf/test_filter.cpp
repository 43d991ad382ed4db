#include "services/ekf/filter.hpp"

#include <gtest/gtest.h>

#include "tests/services/ekf/simulated_drive.hpp"

namespace curbstone {
namespace {

struct Result {
  std::vector<Estimate> estimates;
  Counters counters;
  Belief belief;
};

/// Feeds a drive in the order of its stamps; `keep` says which samples the filter gets.
template <class KeepImu, class KeepWheels>
Result run(const EkfConfig& config, const Drive& drive, KeepImu keep_imu, KeepWheels keep_wheels) {
  Filter filter(config);
  Result result;
  std::size_t w = 0;
  for (const ImuSample& imu : drive.imu) {
    for (; w < drive.wheels.size() && drive.wheels[w].utime <= imu.utime; ++w)
      if (keep_wheels(drive.wheels[w])) filter.add(drive.wheels[w], result.estimates);
    if (keep_imu(imu)) filter.add(imu, result.estimates);
  }
  result.counters = filter.counters();
  result.belief = filter.belief();
  return result;
}
Result run(const EkfConfig& config, const Drive& drive) {
  const auto all = [](const auto&) { return true; };
  return run(config, drive, all, all);
}

/// From here: seconds since the drive began.
[[maybe_unused]] double seconds_in(const Drive& drive, std::int64_t utime) {
  return seconds_between(drive.imu.front().utime, utime);
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
  for (const Estimate& e : result.estimates) {
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
  const EkfConfig config;
  const Drive drive = simulate_drive(typical(), config.vehicle);
  const Result result = run(config, drive);
  print("typical", result, drive);
  const Errors errors = errors_of(result, drive);
  EXPECT_LT(errors.position, 0.01 * drive.distance);
  EXPECT_LT(errors.tilt, 0.5 * kDegree);
  EXPECT_LT(errors.yaw, 0.5 * kDegree);
}

}  // namespace
}  // namespace curbstone
