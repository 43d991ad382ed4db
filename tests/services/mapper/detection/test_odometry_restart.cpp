#include "services/mapper/detection/odometry_restart.hpp"

#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "common/bus/local_bus.hpp"
#include "services/mapper/mapper_node.hpp"
#include "tests/services/mapper/mapper_drive.hpp"

namespace curbstone::mapper::detection {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(OdometryRestart, IsRecentForFiveSecondsAfterAGap) {
  OdometryRestart restart;
  std::int64_t utime = 1'700'000'000'000'000;
  const auto drive = [&](int revolutions, std::int64_t step) {
    for (int i = 0; i < revolutions; ++i) restart.add(utime += 50'000, step);
  };
  drive(20, 10'000);
  EXPECT_FALSE(restart.is_recent());
  drive(1, 120'000);
  EXPECT_TRUE(restart.is_recent());
  drive(99, 10'000);
  EXPECT_TRUE(restart.is_recent());
  drive(1, 10'000);
  EXPECT_FALSE(restart.is_recent());
}

TEST(OdometryRestart, IsNoneWhereOdometryIsSlow) {
  OdometryRestart restart;
  for (int i = 0; i < 40; ++i) {
    restart.add(1'700'000'000'000'000 + i * 50'000, 100'000 + 1000 * (i % 3));
    EXPECT_FALSE(restart.is_recent());
  }
}

/// What the mapper says after 4 s in which odometry turned by 2.5 degrees at once, and had been silent for so many s
/// half a second before.
std::vector<std::string> faults_after(double silent) {
  constexpr double kJump = 2.0;  // s
  LocalBus bus;
  MapperNode node(config::MapperConfig{}, bus);
  node.connect(bus);
  test::SyntheticWorld world = test::street();
  world.noise = 0.01;
  const Pose there = test::driving(0).inverse() * test::driving(kJump);
  const Pose turned = there * test::pose(0, 0, 0, 0, 0, 2.5 * test::kDegree) * there.inverse();
  double sent = -0.1;
  for (int n = 0; n < 80; ++n) {
    for (; sent < (n + 1) * test::kPeriod + 0.02; sent += 0.01) {
      if (sent > kJump - 0.5 - silent && sent < kJump - 0.5) continue;
      odometry_t m{};
      m.utime = test::utime(sent);
      m.flags = odometry_t::INITIALISED;
      const Pose moved = test::driving(0).inverse() * test::driving(sent);
      pose_to_arrays(sent < kJump ? moved : turned * moved, m.position, m.orientation);
      bus.publish("ODOMETRY", m);
    }
    for (const lidar_points_t& packet :
         world.packets(test::driving, test::default_lidar(), n, n * test::kPeriod, test::kPeriod))
      bus.publish("LIDAR_POINTS", packet);
    bus.dispatch();
    for (int i = 0; i < 25; ++i) node.tick(test::utime(n * test::kPeriod + 0.02 * i));  // what is lost is given up
    bus.dispatch();
  }
  return node.report().faults;
}

TEST(OdometryRestart, OfTheFilterIsNoFaultOfTheLidarOrTheGyro) {
  EXPECT_THAT(faults_after(0.15), Not(Contains(HasSubstr("LiDAR and odometry differ"))));
  EXPECT_THAT(faults_after(0), Contains(HasSubstr("LiDAR and odometry differ"))) << "a gyro that is wrong";
}

}  // namespace
}  // namespace curbstone::mapper::detection
