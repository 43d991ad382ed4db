#include "tools/bench/mapping/methods/loam_cloud.hpp"

#include <gtest/gtest.h>

#include "tests/services/mapper/mapper_drive.hpp"

namespace curbstone::bench::mapping::methods {
namespace {

TEST(LoamCloudTest, KeepsAPointAVoxelOfEachKindAndGrowsWithTheGroundAlone) {
  test::MapperDrive drive;
  LoamCloud cloud(drive.config.vehicle);
  std::size_t after_five = 0;
  for (int i = 0; i < 12; ++i) {
    const mapper::scan::Scan scan = drive.next();
    cloud.add(scan, {scan.end, drive.truth(scan.end)});
    if (i == 5) after_five = cloud.cloud().points.size();
    if (i > 0) continue;
    EXPECT_EQ(cloud.cloud().points.size(), 0u) << "nothing tells how the vehicle moved";
  }
  EXPECT_GT(cloud.edges(), 20u);
  EXPECT_GT(cloud.planes(), 500u);
  EXPECT_EQ(cloud.edges() + cloud.planes(), cloud.cloud().points.size());
  EXPECT_LT(cloud.cloud().points.size(), 2 * after_five) << "the same places are not kept again";
  int off = 0;
  for (const map_export::CloudPoint& p : cloud.cloud().points) off += p.position.z() < -0.1F ? 1 : 0;
  EXPECT_EQ(off, 0) << "below the ground of the world that it was taken in";
}

}  // namespace
}  // namespace curbstone::bench::mapping::methods
