// An IMU that speaks in other units, or has another axis up for its gyro only: it is named, and odometry does without.
#include <algorithm>
#include <functional>
#include <optional>

#include "tests/services/ekf/ekf_node_test.hpp"
#include "tests/services/ekf/town_drive.hpp"

namespace curbstone::ekf::mounting {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

constexpr double kSeconds = 150.0;

struct Driven {
  std::vector<std::string> faults;
  Counters counters;
  std::size_t published = 0;
  std::size_t found = 0;      // s after the start, when the gyro was found wrong; 0: never
  std::size_t not_level = 0;  // messages
};

Driven driven(const std::function<void(base::ImuSample&)>& spoil) {
  Drive drive = simulate_town_drive({.seconds = kSeconds, .speed = 5, .slip = false}, VehicleConfig());
  for (base::ImuSample& sample : drive.imu) spoil(sample);
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
  return {report.faults, report.counters, odometry.size(), found, static_cast<std::size_t>(not_level)};
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

TEST(WrongImu, OneThatIsTurnedByARightAngleIsNotUsedOnceItIsFound) {
  Driven turned = driven([](base::ImuSample& sample) {
    for (Eigen::Vector3d* v : {&sample.acceleration, &sample.angular_rate})
      *v = Eigen::Vector3d(v->y(), -v->x(), v->z());
  });
  EXPECT_THAT(turned.faults, Contains(HasSubstr("its forward is not the wheels', and it is not used: add about")));
  EXPECT_GT(turned.counters["refused.misplaced.imu"], 5'000);
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

TEST(WrongImu, OneThatIsRightIsUsed) {
  Driven right = driven([](base::ImuSample&) {});
  EXPECT_TRUE(right.faults.empty());
  EXPECT_EQ(right.counters["faults.gyro_z"], 0);
  EXPECT_EQ(right.counters["refused.misplaced.imu"], 0);
}

}  // namespace
}  // namespace curbstone::ekf::mounting
