#include <gmock/gmock.h>

#include "services/mapper/mapper.hpp"
#include "tests/services/mapper/mapper_drive.hpp"

namespace curbstone::mapper {
namespace {

using test::kPeriod;
using test::utime;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// 20 s along the street, off at 1.5 m/s^2 and on at 3 m/s.
struct StreetDrive : test::MapperDrive {
  StreetDrive() {
    trajectory = [](double t) {
      return test::pose(-28 + (t < 0 ? 0 : t < 2 ? 0.75 * t * t : 3 * t - 3), 0, 0, 0, 0, 0);
    };
  }
  /// Odometry shows `share` of the way from `from` to `until`, s.
  void with_odometry_wrong(double from, double until, double share) {
    double way = 0;
    for (double t = -0.05; t < 21; t += 0.01) {
      odometry.add({utime(t), test::pose(way, 0, 0, 0, 0, 0), true, false});
      const double went = (trajectory(t).inverse() * trajectory(t + 0.01)).translation().x();
      way += went * (t >= from && t < until ? share : 1);
    }
  }
  std::optional<MapperUpdate> steps(int n) {
    std::optional<MapperUpdate> update;
    for (int i = 0; i < n; ++i) update = step();
    return update;
  }
  [[nodiscard]] std::string fault() const {
    std::vector<std::string> faults;
    mapper->add_faults(faults);
    return faults.empty() ? "" : faults.front();
  }
};

TEST(MapperWay, RightOdometryIsNoFault) {
  StreetDrive drive;
  drive.with_odometry_wrong(0, 0, 1);
  (void)drive.steps(360);
  EXPECT_THAT(drive.fault(), IsEmpty());
  EXPECT_EQ(drive.mapper->counters()["faults.odometry.way"], 0);
  EXPECT_EQ(drive.mapper->counters()["faults.lidar.aside"], 0);
}

/// `share`: of the way that the vehicle goes, by odometry.
void expect_the_lidar_alone(double share) {
  StreetDrive drive;
  drive.with_odometry_wrong(6, 13, share);
  (void)drive.steps(120);
  ASSERT_THAT(drive.fault(), IsEmpty()) << share;
  (void)drive.steps(60);
  EXPECT_THAT(drive.fault(), HasSubstr("The map goes by the LiDAR alone")) << share;
  for (int i = 0; i < 70; ++i) {
    const auto update = drive.step();
    ASSERT_TRUE(update && update->registered) << share;
    EXPECT_LT(drive.error(*update), 0.2) << share << " " << i;
  }
  const auto update = drive.steps(110);
  EXPECT_THAT(drive.fault(), IsEmpty()) << share << ": it is right again";
  ASSERT_TRUE(update && update->registered && update->with_odometry) << share;
  EXPECT_LT(drive.error(*update), 0.15) << share;
  EXPECT_EQ(drive.mapper->counters()["faults.odometry.way"], 1) << share;
}

TEST(MapperWay, WhereOdometryStandsInMidDriveTheMapGoesByTheLidarAlone) {
  expect_the_lidar_alone(0.0);
}

TEST(MapperWay, WhereOdometryIsHalfOrTwiceAsFastInMidDriveTheMapGoesByTheLidarAlone) {  // long
  expect_the_lidar_alone(0.5);
  expect_the_lidar_alone(2.0);
}

TEST(MapperWay, ALidarThatLooksBackwardsOrAsideIsNamed) {
  for (const double yaw : {3.14159, 1.5708}) {
    StreetDrive drive;
    drive.with_odometry_wrong(0, 0, 1);
    for (int i = 0; i < 100; ++i) {
      const int n = drive.turn++;
      (void)drive.step(test::scan_of(
          drive.world.packets(drive.trajectory, drive.config.vehicle.T_base_lidar() * test::pose(0, 0, 0, 0, 0, yaw), n,
                              n * kPeriod, kPeriod)));
    }
    EXPECT_THAT(drive.fault(), HasSubstr("LiDAR: it sees the vehicle drive")) << yaw;
  }
}

}  // namespace
}  // namespace curbstone::mapper
