#include "tools/bench/mapping/loam_cloud.hpp"

#include <gtest/gtest.h>

#include "tests/services/mapper/mapper_drive.hpp"

namespace curbstone {
namespace {

TEST(LoamCloudTest, KeepsAPointAVoxelOfEachKindAndGrowsWithTheGroundAlone) {
  test::MapperDrive drive;
  LoamCloud cloud(drive.config.vehicle);
  std::size_t after_five = 0;
  for (int i = 0; i < 12; ++i) {
    const Revolution revolution = drive.next();
    cloud.add(revolution, {revolution.end, drive.truth(revolution.end)});
    if (i == 5) after_five = cloud.cloud().points.size();
    if (i > 0) continue;
    EXPECT_EQ(cloud.cloud().points.size(), 0u) << "nothing tells how the vehicle moved";
  }
  EXPECT_GT(cloud.edges(), 20u);
  EXPECT_GT(cloud.planes(), 500u);
  EXPECT_EQ(cloud.edges() + cloud.planes(), cloud.cloud().points.size());
  EXPECT_LT(cloud.cloud().points.size(), 2 * after_five) << "the same places are not kept again";
  int off = 0;
  for (const CloudPoint& p : cloud.cloud().points) off += p.position.z() < -0.1F ? 1 : 0;
  EXPECT_EQ(off, 0) << "below the ground of the world that it was taken in";
}

}  // namespace
}  // namespace curbstone
