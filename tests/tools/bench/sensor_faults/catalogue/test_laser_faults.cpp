#include <gmock/gmock.h>

#include <cmath>

#include "tests/tools/bench/sensor_faults/catalogue/fault_helpers.hpp"
#include "tools/bench/sensor_faults/catalogue/points.hpp"

namespace curbstone::bench::sensor_faults::catalogue {
namespace {

/// A return of each laser of the RS16, 10 m away to the left.
lidar_points_t a_return_of_each_laser() {
  std::vector<SomePoint> points;
  for (int ring = 0; ring < 16; ++ring) {
    const double elevation = radians(2.0 * ring - 15.0);
    points.push_back({0, float(10 * std::cos(elevation)), float(10 * std::sin(elevation))});
  }
  return some_points(points);
}

double elevation_of(const lidar_points_t& m, std::size_t i) {
  return std::asin(double(m.z[i]) / std::hypot(double(m.x[i]), double(m.y[i]), double(m.z[i]))) / radians(1);
}

TEST(LaserFaults, OneLaserIsWrongAndTheOthersAreNot) {
  const lidar_points_t before = a_return_of_each_laser();
  const lidar_points_t longer = after(fault_named("one laser 15 cm long"), before).at(0);
  const lidar_points_t low = after(fault_named("one laser 0.6 deg low"), before).at(0);
  const lidar_points_t aside = after(fault_named("one laser 3 deg aside"), before).at(0);
  EXPECT_NEAR(std::hypot(longer.y[4], longer.z[4]), 10.15, 1e-5);
  EXPECT_NEAR(elevation_of(low, 4), -7 + 0.6, 1e-5);
  EXPECT_NEAR(std::atan2(aside.y[4], aside.x[4]), radians(93), 1e-6);
  for (const lidar_points_t* m : {&longer, &low, &aside}) {
    EXPECT_NEAR(m->y[5], before.y[5], 1e-5);
    EXPECT_NEAR(m->z[5], before.z[5], 1e-5);
  }
  EXPECT_EQ(after(fault_named("one laser dead"), before).at(0).num_points, 15);
}

TEST(LaserFaults, LasersAreTakenForEachOther) {
  const lidar_points_t m = after(fault_named("two lasers swapped"), a_return_of_each_laser()).at(0);
  EXPECT_EQ(m.ring[3], 6);
  EXPECT_EQ(m.ring[6], 3);
  EXPECT_EQ(m.ring[4], 4);
  EXPECT_NEAR(elevation_of(m, 3), -3, 1e-4);
  EXPECT_NEAR(elevation_of(m, 6), -9, 1e-4);
  EXPECT_NEAR(elevation_of(m, 4), -7, 1e-4);
}

TEST(PacketFaults, ALoopSendsWhatWasSentASecondAgo) {
  const Changes loop = fault_named("packets of a second ago").make();
  for (int i = 0; i < 760; ++i) {
    lidar_points_t m = some_points({{10, 0, -1}}, 1'000'000 + 1'333 * i);
    m.packet = i;
    EXPECT_EQ(loop.second_lidar(20, m), i >= 750);
    if (i >= 750) {
      EXPECT_EQ(m.packet, i - 750);
    }
  }
}

TEST(PacketFaults, ADeviceStartsAgainIn2000) {
  const Changes again = fault_named("IMU starts again in 2000").make();
  imu_t m = some_imu();
  EXPECT_FALSE(again.imu(kOnTheWay + 4, m));
  m = some_imu(50'000'000);
  EXPECT_TRUE(again.imu(kOnTheWay + 5, m));
  EXPECT_EQ(m.utime, 946'684'800'000'000);
  m = some_imu(50'010'000);
  EXPECT_TRUE(again.imu(kOnTheWay + 5.01, m));
  EXPECT_EQ(m.utime, 946'684'800'010'000);
}

TEST(GroundFaults, LidarAndGyroSeeTheGroundTurnAndTheWheelsDoNot) {
  const Changes changes = fault_named("turntable").make();
  imu_t imu = some_imu();
  changes.imu(1.0, imu);
  EXPECT_NEAR(imu.angular_rate[2], 0.3 + 0.052, 1e-9);
  lidar_points_t m = some_points({{10, 0, -1}});
  changes.lidar(2.0, m);
  EXPECT_NEAR(std::atan2(m.y[0], m.x[0]), 1.5 * 0.052, 1e-4) << "it looks 4.5 deg to the right, and turns left";
  EXPECT_FALSE(changes.wheels);
}

}  // namespace
}  // namespace curbstone::bench::sensor_faults::catalogue
