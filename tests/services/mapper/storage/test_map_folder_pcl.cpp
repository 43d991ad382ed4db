#include <gtest/gtest.h>
#include <pcl/io/pcd_io.h>
#include <pcl/point_types.h>

#include "services/mapper/storage/map_folder.hpp"
#include "services/mapper/storage/map_folder_rules.hpp"
#include "tests/services/mapper/storage/saved_map_fixture.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::mapper::storage {
namespace {

TEST(MapFolderAndPcl, PclReadsATileAsPointsInMap) {
  const auto scratch = test::TemporaryFolder::in_memory();
  const SavedMap map = random_map(1, 3, 1);
  save_map(map, scratch / "town");
  for (const SavedTile& tile : map.tiles) {
    pcl::PointCloud<pcl::PointXYZI> cloud;
    ASSERT_EQ(pcl::io::loadPCDFile((scratch / "town" / map_tile_file(tile.key)).string(), cloud), 0);
    ASSERT_EQ(cloud.size(), tile.points.size());
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const TilePoint& p = tile.points[i];
      EXPECT_FLOAT_EQ(cloud[i].x, static_cast<float>(tile.key.x * kTileSize + p.x * kPositionStep));
      EXPECT_FLOAT_EQ(cloud[i].y, static_cast<float>(tile.key.y * kTileSize + p.y * kPositionStep));
      EXPECT_FLOAT_EQ(cloud[i].z, static_cast<float>(tile.z_origin + p.z * kPositionStep));
      EXPECT_EQ(cloud[i].intensity, p.intensity);
    }
  }
}

TEST(MapFolderAndPcl, PclReadsANodeAndWhereItWasTaken) {
  const auto scratch = test::TemporaryFolder::in_memory();
  const SavedMap map = random_map(2, 1, 2);
  save_map(map, scratch / "town");
  pcl::PointCloud<pcl::PointXYZ> cloud;
  ASSERT_EQ(pcl::io::loadPCDFile((scratch / "town" / keyframe_file(1)).string(), cloud), 0);
  ASSERT_EQ(cloud.size(), map.nodes[1].points.size());
  EXPECT_TRUE(cloud[5].getVector3fMap().isApprox(scan::unpack((*map.nodes[1].points.read())[5])));
  const Pose& pose = map.nodes[1].T_map_base;
  EXPECT_TRUE(cloud.sensor_origin_.head<3>().isApprox(pose.translation().cast<float>()));
  EXPECT_TRUE(cloud.sensor_orientation_.toRotationMatrix().isApprox(pose.linear().cast<float>(), 1e-5F));
}

TEST(MapFolderAndPcl, ATileThatPclWroteLoads) {
  const auto scratch = test::TemporaryFolder::in_memory();
  SavedMap map = random_map(3, 1, 0);
  save_map(map, scratch / "town");
  const std::string file = (scratch / "town" / map_tile_file(map.tiles[0].key)).string();
  pcl::PointCloud<pcl::PointXYZI> cloud;
  ASSERT_EQ(pcl::io::loadPCDFile(file, cloud), 0);
  cloud.erase(cloud.begin() + 4);  // as whoever takes a ghost out of the map by hand
  map.tiles[0].points.erase(map.tiles[0].points.begin() + 4);
  ASSERT_EQ(pcl::io::savePCDFileBinary(file, cloud), 0);
  EXPECT_TRUE(equal(load_map(scratch / "town"), map));
}

}  // namespace
}  // namespace curbstone::mapper::storage
