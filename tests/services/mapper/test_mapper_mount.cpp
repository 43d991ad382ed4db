// A LiDAR that is loose in its mount, in the whole mapper.
#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "tests/services/mapper/mapper_drive.hpp"

namespace curbstone::mapper {
namespace {

using test::kDegree;
using test::kPeriod;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A drive with odometry and a LiDAR that has turned by mount_yaw(t), rad, to the left.
struct LooseMountDrive : test::MapperDrive {
  LooseMountDrive() { with_odometry(20); }
  /// Drives until `end`, s. The pose's largest error is kept: m, and rad of yaw.
  void until(double end, const std::function<double(double)>& mount_yaw) {
    for (; turn * kPeriod < end; ++turn) {
      Pose T_base_lidar = config.vehicle.T_base_lidar();
      T_base_lidar.linear() =
          Eigen::AngleAxisd(mount_yaw(turn * kPeriod), Eigen::Vector3d::UnitZ()) * T_base_lidar.linear();
      const auto update = step(test::scan_of(world.packets(trajectory, T_base_lidar, turn, turn * kPeriod, kPeriod)));
      ASSERT_TRUE(update) << turn;
      metres = std::max(metres, error(*update));
      radians = std::max(radians, angle_of(truth(update->utime).inverse() * T_world_map * update->T_map_base));
    }
  }
  [[nodiscard]] std::vector<std::string> faults() const {
    std::vector<std::string> faults;
    mapper->add_faults(faults);
    return faults;
  }
  double metres = 0, radians = 0;
};

TEST(MapperMount, AKnockIsTakenIntoTheMountAndNotIntoThePose) {
  LooseMountDrive drive;
  drive.until(3, [](double) { return 0; });
  EXPECT_THAT(drive.faults(), IsEmpty());
  drive.until(6, [](double) { return 5 * kDegree; });
  EXPECT_EQ(drive.mapper->counters()["faults.lidar.turned_in_mount"], 1);
  EXPECT_LE(drive.mapper->counters()["refused.mount"], 5);
  EXPECT_THAT(drive.faults(), Contains(HasSubstr("looks 5.0 deg to the left of where vehicle.lidar says")));
  EXPECT_LT(drive.metres, 0.05);
  EXPECT_LT(drive.radians, 0.5 * kDegree);
}

TEST(MapperMount, NothingIsMappedWhileTheLidarShakes) {
  const auto shake = [](double t) { return 1.5 * kDegree * std::sin(2 * std::numbers::pi * 3 * t); };
  LooseMountDrive drive;
  drive.until(3, [](double) { return 0; });
  drive.until(5, shake);
  EXPECT_THAT(drive.faults(), Contains(HasSubstr("shakes in its mount")));
  const std::int64_t mapped = drive.dense().size();
  drive.until(8, shake);
  EXPECT_EQ(drive.dense().size(), mapped);
  EXPECT_LT(drive.metres, 0.1) << "by odometry";
}

}  // namespace
}  // namespace curbstone::mapper
