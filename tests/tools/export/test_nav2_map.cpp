#include <yaml-cpp/yaml.h>

#include <cmath>

#include "common/tiles/tile.hpp"
#include "tests/tools/export/exported_map.hpp"

namespace curbstone::map_export {
namespace {

/// map_server's rule (nav2_map_server, map_io: loadMapFromFile) for a pixel: 0 free .. 100 occupied, -1 unknown.
int occupancy(const YAML::Node& yaml, double pixel, double alpha) {
  const double free = yaml["free_thresh"].as<double>();
  const double occupied = yaml["occupied_thresh"].as<double>();
  const double shade = pixel / 255;
  const double occ = yaml["negate"].as<int>() != 0 ? shade : 1 - shade;
  if (yaml["mode"].as<std::string>() == "trinary") {
    if (occupied < occ) return 100;
    return occ < free ? 0 : -1;
  }
  if (alpha < 255) return -1;
  if (occupied <= occ) return 100;
  if (occ <= free) return 0;
  return static_cast<int>(std::rint((occ - free) / (occupied - free) * 100));
}

class Nav2Map : public ExportedMap {
 protected:
  void SetUp() override {
    ExportedMap::SetUp();
    if (!has_gdal()) GTEST_SKIP() << "no GDAL programs here";
    semantic_map::tile::MapTile tile;
    tile.key = {-2, 1};
    tile.cell_class.fill(semantic_map::tile::CellClass::kRoad);
    set(tile, 1, semantic_map::tile::CellClass::kCurb, 110);
    set(tile, 2, semantic_map::tile::CellClass::kObstacle, 254);
    set(tile, 3, semantic_map::tile::CellClass::kUnknown, 255);
    set(tile, 4, semantic_map::tile::CellClass::kUnknown, 0);  // as with unknown_is_free
    write_map({tile}, {});
  }
  static void set(semantic_map::tile::MapTile& tile, std::size_t i, semantic_map::tile::CellClass cell_class,
                  int cost) {
    tile.cell_class[i] = cell_class;
    tile.cost[i] = static_cast<std::uint8_t>(cost);
  }
  /// Of the lowest row's first five cells, found by the YAML's origin and resolution.
  std::vector<int> lowest_row(const std::string& name) const {
    const YAML::Node yaml = YAML::LoadFile(out(name));
    EXPECT_NEAR(yaml["origin"][0].as<double>(), -2 * kTileSize, 1e-9);
    EXPECT_NEAR(yaml["origin"][1].as<double>(), 1 * kTileSize, 1e-9);
    EXPECT_EQ(yaml["resolution"].as<double>(), kCellSize);
    const std::string image = out(yaml["image"].as<std::string>());
    const auto pixels = cells_of(image);
    const auto alpha = image.ends_with(".png") ? cells_of(image, 2) : decltype(pixels){};
    EXPECT_EQ(pixels.size(), std::size_t{semantic_map::tile::kCellsInTile});
    std::vector<int> row;
    for (std::size_t i = semantic_map::tile::kCellsInTile - kCellsPerTile;
         i < semantic_map::tile::kCellsInTile - kCellsPerTile + 5U; ++i)
      row.push_back(occupancy(yaml, pixels[i][2], alpha.empty() ? 255 : alpha[i][2]));
    return row;
  }
};

using ::testing::ElementsAre;

TEST_F(Nav2Map, TakesTheSafeSideUnlessToldOtherwise) {
  ASSERT_EQ(run({"--only", "nav2"}), 0);
  EXPECT_THAT(lowest_row("nav2.yaml"), ElementsAre(0, 100, 100, 100, 100));
  EXPECT_THAT(lowest_row("nav2_scale.yaml"), ElementsAre(0, 43, 100, 100, 100));  // 110 of 254: 43 of 100
}

TEST_F(Nav2Map, LeavesTheUnknownToThePlannerOnRequest) {
  ASSERT_EQ(run({"--only", "nav2", "--unknown", "unknown"}), 0);
  EXPECT_THAT(lowest_row("nav2.yaml"), ElementsAre(0, 100, 100, -1, -1));
  EXPECT_THAT(lowest_row("nav2_scale.yaml"), ElementsAre(0, 43, 100, -1, -1));
}

TEST_F(Nav2Map, DrivesAnywhereWithThePapersPolicy) {
  ASSERT_EQ(run({"--only", "nav2", "--unknown", "free", "--occupied-cost", "254"}), 0);
  EXPECT_THAT(lowest_row("nav2.yaml"), ElementsAre(0, 0, 100, 0, 0));
  EXPECT_THAT(lowest_row("nav2_scale.yaml"), ElementsAre(0, 43, 100, 0, 0));
}

TEST_F(Nav2Map, TakesThePolicyFromTheVehiclesFileUnlessTold) {
  std::ofstream(path("ugv.yaml")) << "semantic_map:\n  classes:\n    unknown_is_free: true\n";
  ASSERT_EQ(run({"--only", "nav2", "--config", path("ugv.yaml")}), 0);
  EXPECT_THAT(lowest_row("nav2.yaml"), ElementsAre(0, 100, 100, 0, 0));
  ASSERT_EQ(run({"--only", "nav2", "--config", path("ugv.yaml"), "--unknown", "occupied"}), 0);
  EXPECT_THAT(lowest_row("nav2.yaml"), ElementsAre(0, 100, 100, 100, 100));
  std::ofstream(path("ugv.yaml")) << "semantic_map:\n  classes:\n    unknown_is_fee: true\n";
  EXPECT_ANY_THROW(run({"--only", "nav2", "--config", path("ugv.yaml")}));
}

}  // namespace
}  // namespace curbstone::map_export
