// An IMU that speaks in other units, or has another axis up for its gyro only: it is named, and odometry does without.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>

#include "common/geometry/geometry.hpp"
#include "tests/services/ekf/ekf_node_test.hpp"
#include "tests/services/ekf/town_drive.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::ekf::mounting {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kSeconds = 150.0;

struct Driven {
  std::vector<std::string> faults;
  Counters counters;
  std::size_t published = 0;
  std::size_t found = 0;      // s after the start, when the gyro was found wrong; 0: never
  std::size_t not_level = 0;  // messages
  double off = 0.0;           // m, at the end
};

Driven driven(
    const std::function<void(base::ImuSample&)>& spoil,
    const std::function<void(base::WheelSample&)>& spoil_wheels = [](base::WheelSample&) {}) {
  Drive drive = simulate_town_drive({.seconds = kSeconds, .speed = 5, .slip = false}, VehicleConfig());
  for (base::ImuSample& sample : drive.imu) spoil(sample);
  for (base::WheelSample& sample : drive.wheels) spoil_wheels(sample);
  LocalBus bus;
  EkfNode node(base::EkfConfig(), bus);
  std::vector<odometry_t> odometry;
  bus.subscribe<odometry_t>("ODOMETRY", [&](const odometry_t& m) { odometry.push_back(m); });
  std::size_t found = 0;
  for (std::size_t i = 0; i < drive.imu.size(); ++i) {
    node.on(message_of(drive.wheels[i], static_cast<std::int32_t>(i)));
    node.on(message_of(drive.imu[i], static_cast<std::int32_t>(i)));
    bus.dispatch();
    if (found == 0 && i % 100 == 0 && node.report().counters["faults.gyro_z"] > 0) found = i / 100;
  }
  const NodeReport report = node.report();
  const auto not_level = std::count_if(odometry.begin(), odometry.end(),
                                       [](const odometry_t& m) { return (m.flags & odometry_t::NOT_LEVEL) != 0; });
  const Eigen::Vector3d end =
      drive.T_odom_base(drive.truth.size() - 1, drive.index_of(odometry.front().utime)).translation();
  const double off = std::hypot(odometry.back().position[0] - end.x(), odometry.back().position[1] - end.y());
  return {report.faults, report.counters, odometry.size(), found, static_cast<std::size_t>(not_level), off};
}

TEST(WrongImu, AnAccelerometerInGIsNotUsedAndTheWheelsStartOdometry) {
  Driven g = driven([](base::ImuSample& sample) { sample.acceleration /= 9.80665; });
  EXPECT_THAT(g.faults, Contains(HasSubstr("its mean acceleration is 1.00 m/s^2, which is not gravity")));
  EXPECT_GT(g.counters["refused.gravity.imu"], 13'000);
  EXPECT_EQ(g.counters["starts.without_imu"], 1);
  EXPECT_GT(g.published, 10'000U);
}

TEST(WrongImu, AGyroInDegreesIsNotUsed) {
  const Driven degrees = driven([](base::ImuSample& sample) { sample.angular_rate *= 57.29578; });
  EXPECT_THAT(degrees.faults, Contains(HasSubstr("its gyro does not turn as the wheels do, and is not used")));
  EXPECT_EQ(degrees.counters["faults.gyro_z"], 1);
  EXPECT_LT(degrees.found, 15) << "while it sets off";
}

TEST(WrongImu, AGyroWithAnotherAxisUpIsNotUsed) {
  const Driven swapped =
      driven([](base::ImuSample& sample) { std::swap(sample.angular_rate.x(), sample.angular_rate.z()); });
  EXPECT_THAT(swapped.faults, Contains(HasSubstr("its gyro does not turn as the wheels do, and is not used")));
  EXPECT_EQ(swapped.counters["faults.gyro_z"], 1);
  EXPECT_LT(swapped.found, 40) << "in the first bend";
  EXPECT_THAT(swapped.faults, Contains(HasSubstr("its +x axis points up, by gravity the +z")));
}

TEST(WrongImu, OneThatIsUpsideDownIsNotUsedFromTheStart) {
  Driven turned = driven([](base::ImuSample& sample) {
    for (Eigen::Vector3d* v : {&sample.acceleration, &sample.angular_rate}) v->tail<2>() *= -1;
  });
  EXPECT_THAT(turned.faults, Contains(HasSubstr("its -z axis points up, by vehicle.imu its +z, and it is not used")));
  EXPECT_GT(turned.counters["refused.misplaced.imu"], 13'000);
  EXPECT_EQ(turned.counters["starts.without_imu"], 1);
  EXPECT_GT(turned.published, 10'000U);
}

/// Found as it sets off. What of the way it had believed until then is the error that remains.
TEST(WrongImu, OneOfAnotherYawIsUsedAsIfTurned) {
  for (const double degrees : {20.0, -45.0, 90.0, -90.0, 180.0}) {
    const Eigen::Matrix3d R_imu_base = rotation_from_rpy(0, 0, degrees * std::numbers::pi / 180).transpose();
    Driven turned = driven([&](base::ImuSample& sample) {
      for (Eigen::Vector3d* v : {&sample.acceleration, &sample.angular_rate}) *v = R_imu_base * *v;
    });
    std::printf("[ figure ] an IMU turned by %.0f deg: %.2f m off after %.0f s\n", degrees, turned.off, kSeconds);
    EXPECT_THAT(turned.faults, Contains(HasSubstr("used as if turned: add about")));
    EXPECT_EQ(turned.counters["imu_turned"], 1);
    EXPECT_EQ(turned.counters["faults.wheel_left"] + turned.counters["faults.wheel_right"], 0);
    EXPECT_LT(turned.off, 5.0) << degrees;
  }
}

TEST(WrongImu, AGyroOfWhichAllAxesGetStuckLeavesTheOdometryUsable) {
  std::optional<base::ImuSample> first, frozen;
  const Driven stuck = driven([&](base::ImuSample& sample) {
    if (!first) first = sample;
    if (sample.utime - first->utime < 60'000'000) return;
    if (!frozen) frozen = sample;
    sample.angular_rate = frozen->angular_rate;
  });
  EXPECT_THAT(stuck.faults, Contains(HasSubstr("the gyro's z axis is stuck")));
  EXPECT_EQ(stuck.not_level, 0U);
}

/// The second process starts on the move, where nothing shows the yaw.
TEST(WrongImu, ItsYawIsKnownToTheProcessThatFollowsAKilledOne) {
  const test::TemporaryFolder folder;
  base::EkfConfig config;
  config.state_file = folder / "ekf.state";
  const Drive drive = simulate_town_drive({.seconds = 60, .speed = 5, .slip = false}, VehicleConfig());
  LocalBus bus;
  std::optional<EkfNode> node(std::in_place, config, bus);
  odometry_t first{}, last{};
  bus.subscribe<odometry_t>("ODOMETRY", [&](const odometry_t& m) {
    if (first.utime == 0) first = m;
    last = m;
  });
  for (std::size_t i = 0; i < drive.imu.size(); ++i) {
    if (i == 2000) {
      node.reset();
      node.emplace(config, bus);
    }
    base::ImuSample imu = drive.imu[i];
    for (Eigen::Vector3d* v : {&imu.acceleration, &imu.angular_rate}) *v = Eigen::Vector3d(v->y(), -v->x(), v->z());
    node->on(message_of(drive.wheels[i], static_cast<std::int32_t>(i)));
    node->on(message_of(imu, static_cast<std::int32_t>(i)));
    node->tick(imu.utime);
    bus.dispatch();
  }
  NodeReport report = node->report();
  EXPECT_EQ(report.counters["starts.inherited"], 1);
  EXPECT_EQ(report.counters["imu_turned"], 0) << "the belief already rests on it";
  EXPECT_THAT(report.faults, Contains(HasSubstr("used as if turned: add about 90 deg")));
  const Eigen::Vector3d end = drive.T_odom_base(drive.truth.size() - 1, drive.index_of(first.utime)).translation();
  EXPECT_LT(std::hypot(last.position[0] - end.x(), last.position[1] - end.y()), 3.0);
}

/// The wheels then turn the vehicle at 7 rad/s, as the gyro does not.
TEST(WrongImu, AWheelThatCountsBackwardsFromTheStartIsNotTheGyrosFault) {
  Driven backwards = driven([](base::ImuSample&) {}, [](base::WheelSample& sample) { sample.angle[0] *= -1; });
  EXPECT_THAT(backwards.faults, Contains(HasSubstr("the left wheel is wrong for long (turns backwards")));
  EXPECT_THAT(backwards.faults, Not(Contains(HasSubstr("IMU"))));
  EXPECT_EQ(backwards.counters["faults.gyro_z"], 0);
  EXPECT_EQ(backwards.not_level, 0U);
}

TEST(WrongImu, OneThatIsRightIsUsed) {
  Driven right = driven([](base::ImuSample&) {});
  EXPECT_TRUE(right.faults.empty());
  EXPECT_EQ(right.counters["faults.gyro_z"], 0);
  EXPECT_EQ(right.counters["refused.misplaced.imu"], 0);
}

}  // namespace
}  // namespace curbstone::ekf::mounting
