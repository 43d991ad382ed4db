#include "services/mapper/detection/range_scale.hpp"

#include <gmock/gmock.h>

#include "tests/services/mapper/detection_scans.hpp"

namespace curbstone::mapper::detection {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A vehicle that drives through the street at 3 m/s, whose map fits together whatever the unit of the ranges.
struct ScaledDrive {
  test::DetectionScans drive;
  RangeScale check{test::default_lidar().translation().z()};
  double ranges = 1, mount = 0, wheels = 1;  // m: by which the LiDAR is higher than the file says

  void go(double seconds) {
    for (double t = 0; t < seconds; t += 0.1) {
      const Pose T_world_base = test::pose(3 * t - 20, 0, 0, 0, 0, 0);
      const Pose T_assumed = test::default_lidar();
      const Pose T_base_lidar = test::pose(0, 0, mount, 0, 0, 0) * T_assumed;
      std::vector<scan::LidarPoint> points = drive.world.snapshot(T_world_base, T_base_lidar);
      for (scan::LidarPoint& point : points) {
        const Eigen::Vector3d p = T_base_lidar.inverse() * point.position.cast<double>();
        point.position = (T_assumed * (ranges * p)).cast<float>();
      }
      Pose T_map_base = T_world_base, T_odom_base = T_world_base;
      T_map_base.translation() *= ranges;
      T_odom_base.translation() *= wheels;
      check.add({test::utime(t), &points, T_map_base, T_odom_base, true});
    }
  }
  [[nodiscard]] std::vector<std::string> faults() const {
    std::vector<std::string> faults;
    check.add_faults(faults);
    return faults;
  }
};

TEST(RangeScale, AnotherUnitIsNamedWithinMetres) {
  for (const double ranges : {0.5, 2.0, 4.0}) {
    ScaledDrive drive;
    drive.ranges = ranges;
    drive.go(1.5);
    ASSERT_TRUE(drive.check.scale()) << ranges;
    EXPECT_NEAR(*drive.check.scale(), ranges, 0.1 * ranges);
    EXPECT_EQ(drive.check.counters()["faults.lidar.range_scale"], 1);
    EXPECT_THAT(drive.faults().front(),
                HasSubstr("times what it should be, by the ground below it and the way driven"));
  }
}

TEST(RangeScale, AMountOrAWheelThatIsWrongIsNot) {
  ScaledDrive sound, high, low, large;
  high.mount = 0.8;
  low.mount = -0.5;
  large.wheels = 1.5;
  for (ScaledDrive* drive : {&sound, &high, &low, &large}) {
    drive->go(5);
    EXPECT_FALSE(drive->check.scale());
    EXPECT_THAT(drive->faults(), IsEmpty());
  }
}

}  // namespace
}  // namespace curbstone::mapper::detection
