#include <gtest/gtest.h>

#include "services/mapper/mapper.hpp"
#include "services/mapper/revolution_assembler.hpp"
#include "tests/services/mapper/kitti_drive.hpp"

namespace curbstone {
namespace {

/// 72 m of a real street on ten beams, the LiDAR alone: what the best of the peers reach is a t_rel of 0.23 to 0.31 %
/// (reference/peers.md).
TEST(RecordedDrive, TheLidarAloneFollowsAStreet) {
  const test::KittiDrive drive = test::load_kitti(CURBSTONE_DATA_DIR "/kitti0005_rs16");
  if (drive.size() == 0) GTEST_SKIP() << "no recorded data in " << CURBSTONE_DATA_DIR;
  MapperConfig config;
  config.vehicle.lidar = {0, 0, 0, 0, 0, 0};
  config.dense.min_height = -4.7;
  Mapper mapper(config);
  RevolutionAssembler assembler;
  const OdometryHistory no_odometry;
  std::vector<Pose> ends;
  std::vector<std::int64_t> times;
  const auto take = [&](const std::optional<Revolution>& revolution) {
    if (!revolution) return;
    const auto update = mapper.process(*revolution, no_odometry);
    ASSERT_TRUE(update && update->registered);
    ends.push_back(update->T_map_base);
    times.push_back(update->utime);
  };
  for (std::size_t scan = 0; scan < drive.size(); ++scan) {
    for (const lidar_points_t& packet : drive.packets(scan)) take(assembler.add(packet));
  }
  take(assembler.flush());
  ASSERT_EQ(ends.size(), drive.size());

  std::vector<Pose> estimate;
  std::vector<Pose> reference;
  for (std::size_t i = 1; i < ends.size(); ++i) {  // the reference speaks of mid-sweep
    const double part =
        static_cast<double>(drive.stamps[i] - times[i - 1]) / static_cast<double>(times[i] - times[i - 1]);
    estimate.push_back(ends[i - 1] * move(twist_of(ends[i - 1].inverse() * ends[i], 1.0), part));
    reference.push_back(drive.reference[i]);
  }
  const test::TrajectoryError error = test::compare(estimate, reference);
  EXPECT_LT(error.t_rel_percent, 0.22);
  EXPECT_LT(error.r_rel_deg_per_m, 0.005);
  EXPECT_LT(error.ate_m, 0.035);
  EXPECT_LT(error.end_percent, 0.2);
}

}  // namespace
}  // namespace curbstone
