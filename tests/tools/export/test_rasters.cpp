#include <cmath>
#include <map>

#include "common/tiles/tile.hpp"
#include "tests/tools/export/exported_map.hpp"

namespace curbstone::map_export {
namespace {

using ::testing::HasSubstr;

class Rasters : public ExportedMap {
 protected:
  void SetUp() override {
    ExportedMap::SetUp();
    if (!has_gdal()) GTEST_SKIP() << "no GDAL programs here";
    write_map(tiles_, {});
  }
  /// Every cell that GDAL reads is the store's cell at that place, and the other way round.
  template <class Value>
  void expect_cells(const std::string& raster, double elsewhere, Value value) const {
    std::map<std::pair<long, long>, double> expected;
    for (const semantic_map::tile::MapTile& tile : tiles_) {
      for (std::size_t i = 0; i < semantic_map::tile::kCellsInTile; ++i) {
        const long column = long{tile.key.x} * kCellsPerTile + static_cast<long>(i % kCellsPerTile);
        const long row = long{tile.key.y} * kCellsPerTile + static_cast<long>(i / kCellsPerTile);
        expected[{column, row}] = value(tile, i);
      }
    }
    std::size_t matched = 0;
    const auto cells = cells_of(out(raster));
    ASSERT_EQ(cells.size(), 75U * 75U);  // tiles -1..1 x -2..0
    for (const auto& cell : cells) {
      const double column = cell[0] / kCellSize - 0.5;
      const double row = cell[1] / kCellSize - 0.5;
      ASSERT_NEAR(column, std::round(column), 1e-6);
      ASSERT_NEAR(row, std::round(row), 1e-6);
      const auto at = expected.find({std::lround(column), std::lround(row)});
      ASSERT_NEAR(cell[2], at == expected.end() ? elsewhere : at->second, 1e-6)
          << raster << " " << cell[0] << " " << cell[1];
      if (at != expected.end()) ++matched;
    }
    EXPECT_EQ(matched, expected.size());
  }

  std::vector<semantic_map::tile::MapTile> tiles_ = varied_tiles();
};

TEST_F(Rasters, HoldEveryCellAtItsPlace) {
  ASSERT_EQ(run({"--only", "rasters"}), 0);
  expect_cells("class.png", 0, [](const semantic_map::tile::MapTile& t, std::size_t i) {
    return static_cast<double>(t.cell_class[i]);
  });
  expect_cells("cost.png", 255,
               [](const semantic_map::tile::MapTile& t, std::size_t i) { return static_cast<double>(t.cost[i]); });
  expect_cells("confidence.png", 0, [](const semantic_map::tile::MapTile& t, std::size_t i) {
    return static_cast<double>(t.confidence[i]);
  });
  expect_cells("hits.png", 0,
               [](const semantic_map::tile::MapTile& t, std::size_t i) { return static_cast<double>(t.hits[i]); });
  expect_cells("height.flt", -9999, [](const semantic_map::tile::MapTile& t, std::size_t i) {
    return t.height[i] == semantic_map::tile::MapTile::kNoHeight ? -9999
                                                                 : double{t.z_origin} + t.height[i] * kPositionStep;
  });
}

TEST_F(Rasters, ClassIsAPictureInTheColoursOfTableOne) {
  ASSERT_EQ(run({"--only", "rasters"}), 0);
  const std::string info = output_of("gdalinfo " + out("class.png"));
  EXPECT_THAT(info, HasSubstr("0: 24,62,40,255"));
  EXPECT_THAT(info, HasSubstr("1: 158,160,162,255"));
  EXPECT_THAT(info, HasSubstr("4: 206,52,44,255"));
}

TEST_F(Rasters, SlopeIsGdalsOwnWhereAllAroundIsGround) {
  ASSERT_EQ(run({"--only", "rasters"}), 0);
  output_of("gdaldem slope -q -p " + out("height.flt") + " " + path("slope.tif"));
  const auto ours = cells_of(out("slope.flt"));
  const auto theirs = cells_of(path("slope.tif"));
  ASSERT_EQ(ours.size(), theirs.size());
  int compared = 0;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    if (ours[i][2] < 0) continue;
    ++compared;
    ASSERT_NEAR(100 * ours[i][2], theirs[i][2], 1e-3) << i;
  }
  EXPECT_GT(compared, 30);
}

TEST_F(Rasters, ADatumPutsThemOnTheEarthAlsoTurned) {
  ASSERT_EQ(run({"--only", "rasters", "--datum", "49.011,8.416,110,25"}), 0);
  // The middle of cell (20, 3) of tile (0, 0), by PROJ: x points 25 deg east of north.
  const double x = 20.5 * kCellSize;
  const double y = 3.5 * kCellSize;
  const double a = 25 * M_PI / 180;
  const std::string lon_lat = output_of(
      "gdaltransform -output_xy -ct '+proj=pipeline +step +inv +proj=topocentric +ellps=WGS84 +lat_0=49.011 "
      "+lon_0=8.416 +h_0=110 +step +inv +proj=cart +ellps=WGS84 +step +proj=unitconvert +xy_in=rad +xy_out=deg'",
      std::to_string(x * std::sin(a) - y * std::cos(a)) + " " + std::to_string(x * std::cos(a) + y * std::sin(a)) +
          " 0\n");
  const semantic_map::tile::MapTile& tile = tiles_[1];
  const std::size_t i = 3 * kCellsPerTile + 20;
  for (const auto& [raster, value] :
       {std::pair{"class.png", static_cast<double>(tile.cell_class[i])},
        std::pair{"cost.png", static_cast<double>(tile.cost[i])},
        std::pair{"height.flt", double{tile.z_origin} + tile.height[i] * kPositionStep}}) {
    const auto read = rows_of(output_of(std::string("gdallocationinfo -valonly -wgs84 ") + out(raster), lon_lat));
    ASSERT_FALSE(read.empty() || read[0].empty()) << raster;
    EXPECT_NEAR(read[0][0], value, 1e-6) << raster;
  }
}

TEST_F(Rasters, AnEarlierDatumDoesNotLinger) {
  ASSERT_EQ(run({"--datum", "49,8"}), 0);
  EXPECT_TRUE(std::filesystem::exists(out("class.png.aux.xml")));
  EXPECT_TRUE(std::filesystem::exists(out("curbs.geojson")));
  ASSERT_EQ(run({}), 0);
  EXPECT_FALSE(std::filesystem::exists(out("class.png.aux.xml")));
  EXPECT_FALSE(std::filesystem::exists(out("curbs.geojson")));
}

}  // namespace
}  // namespace curbstone::map_export
