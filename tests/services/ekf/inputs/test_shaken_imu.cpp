// An IMU that is shaken so hard that the wheels alone know more: it is not used until the shaking ends.
#include "services/ekf/inputs/shaken_imu.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/services/ekf/ekf_node_test.hpp"
#include "tests/services/ekf/town_drive.hpp"

namespace curbstone::ekf::inputs {
namespace {

/// White noise of an IMU at 100 Hz.
class ShakenImuTest : public ::testing::Test {
 protected:
  /// 1 sigma of a sample, rad/s and m/s^2. Returns whether the IMU was called shaken at the end.
  bool shake(double seconds, double gyro, double accelerometer) {
    for (int i = 0; i < std::lround(100 * seconds); ++i) {
      base::ImuSample sample;
      sample.utime = utime_ += 10'000;
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        sample.angular_rate[axis] = gyro * normal_(engine_);
        sample.acceleration[axis] = accelerometer * normal_(engine_);
      }
      imu_.add(sample);
    }
    return imu_.shaken();
  }
  ShakenImu imu_{base::EkfConfig()};

 private:
  std::int64_t utime_ = 1'000'000;
  std::mt19937 engine_{3};
  std::normal_distribution<double> normal_;
};

TEST_F(ShakenImuTest, RoughRoadsAndPoorUnitsAreNot) {
  EXPECT_FALSE(shake(20, 0.0012, 0.012));
  EXPECT_FALSE(shake(20, 0.0012, 3.0));
  EXPECT_FALSE(shake(20, 0.02, 3.0));
  EXPECT_FALSE(shake(20, 0.2, 0.012));
}

TEST_F(ShakenImuTest, OneThatWouldCostTheLevelIsWithinTwoSeconds) {
  shake(20, 0.0012, 0.012);
  EXPECT_TRUE(shake(2, 0.2, 6.0));
}

TEST_F(ShakenImuTest, TheTiltErrorIsThatOfASteadyStateKalmanFilter) {
  shake(20, 0.2, 6.0);
  // Scalar filter at 100 Hz: the tilt walks by 0.2 rad/s * 0.01 s a sample and is measured with 6 / 9.81 rad.
  double variance = 1.0;
  const double measured = 6.0 / 9.80665 * 6.0 / 9.80665;
  for (int i = 0; i < 10'000; ++i) {
    variance += 0.002 * 0.002;
    variance = variance * measured / (variance + measured);
  }
  EXPECT_NEAR(imu_.tilt_sigma(), std::sqrt(variance), 0.15 * std::sqrt(variance));
}

TEST_F(ShakenImuTest, ItIsUsedAgainWhenItHasBeenCalmForTwoSeconds) {
  shake(20, 0.2, 6.0);
  EXPECT_TRUE(shake(2.0, 0.0012, 0.012));
  EXPECT_FALSE(shake(10, 0.0012, 0.012));
}

}  // namespace
}  // namespace curbstone::ekf::inputs

namespace curbstone::ekf {
namespace {

struct ShakenOutcome {
  double position = 0.0;   // m, largest error on the ground
  int not_level = 0;       // estimates
  double without_imu = 0;  // s
  NodeReport report;
};

class ShakenImuOfANode : public EkfNodeTest {
 protected:
  /// Drives through a town for 60 s, with white noise of these sigmas from `begin` to `end`, s.
  ShakenOutcome drive(double gyro, double accelerometer, double begin, double end) {
    Rig rig(config_);
    const Drive drive = simulate_town_drive({.seconds = 60.0}, config_.vehicle);
    std::mt19937 engine(5);
    std::normal_distribution<double> normal;
    ShakenOutcome outcome;
    for (std::size_t i = 0; i < drive.imu.size(); ++i) {
      base::ImuSample imu = drive.imu[i];
      const double t = base::seconds_between(drive.imu.front().utime, imu.utime);
      for (Eigen::Index axis = 0; begin <= t && t < end && axis < 3; ++axis) {
        imu.angular_rate[axis] += gyro * normal(engine);
        imu.acceleration[axis] += accelerometer * normal(engine);
      }
      if (i < drive.wheels.size()) rig.send("WHEELS", message_of(drive.wheels[i], static_cast<std::int32_t>(i)));
      rig.send("IMU", message_of(imu, static_cast<std::int32_t>(i)));
      if (t < end) outcome.report = rig.node.report();
    }
    rig.finish();
    const std::size_t start = drive.index_of(rig.odometry.front().utime);
    for (const odometry_t& message : rig.odometry) {
      const Pose truth = drive.T_odom_base(std::min(drive.index_of(message.utime), drive.truth.size() - 1), start);
      const Pose pose = pose_from_arrays(message.position, message.orientation);
      outcome.position = std::max(outcome.position, (pose.translation() - truth.translation()).head<2>().norm());
      outcome.not_level += (message.flags & odometry_t::NOT_LEVEL) != 0;
      outcome.without_imu += (message.flags & odometry_t::NO_IMU) != 0 ? 0.01 : 0.0;
    }
    std::printf(
        "[ figure ] %.2f rad/s, %.1f m/s^2 from %.0f to %.0f s: at most %.2f m off, %d not level, %.1f s coasted\n",
        gyro, accelerometer, begin, end, outcome.position, outcome.not_level, outcome.without_imu);
    return outcome;
  }
  static bool says(const NodeReport& report, const char* words) {
    return std::any_of(report.faults.begin(), report.faults.end(),
                       [&](const std::string& fault) { return fault.find(words) != std::string::npos; });
  }
};

TEST_F(ShakenImuOfANode, TheWheelsCarryOdometryOnAndItStaysUsable) {
  for (const double share : {0.5, 1.0, 2.0}) {
    const ShakenOutcome o = drive(0.3 * share, 8.0 * share, 15.0, 100.0);
    EXPECT_LT(o.position, 6.0) << share;  // without a gyro the wheels' slips turn it
    EXPECT_EQ(o.not_level, 0) << share;
    EXPECT_GT(o.without_imu, 40.0) << share;
    EXPECT_TRUE(says(o.report, "shaken so hard that it is not used")) << share;
    EXPECT_GT(Counters(o.report.counters)["refused.shaken.imu"], 4000) << share;
  }
}

TEST_F(ShakenImuOfANode, SoTheyDoFromTheStart) {
  const ShakenOutcome o = drive(0.3, 8.0, 0.0, 100.0);
  EXPECT_LT(o.position, 8.0);
  EXPECT_GT(o.without_imu, 40.0);
}

TEST_F(ShakenImuOfANode, AfterTheShakingTheImuIsUsedAgain) {
  const ShakenOutcome o = drive(0.3, 8.0, 15.0, 30.0);
  EXPECT_LT(o.position, 3.0);
  EXPECT_LT(o.without_imu, 25.0);
}

}  // namespace
}  // namespace curbstone::ekf
