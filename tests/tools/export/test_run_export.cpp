#include <sqlite3.h>

#include <limits>

#include "tests/tools/export/exported_map.hpp"

namespace curbstone::map_export {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::ThrowsMessage;

class RunExport : public ExportedMap {
 protected:
  void expect_failure(const std::string& words) const {
    EXPECT_THAT([&] { run({}); },
                ThrowsMessage<std::exception>(AllOf(HasSubstr("map.db"), HasSubstr(words), Not(HasSubstr("\n")))));
    const bool nothing = !std::filesystem::exists(path("out")) || std::filesystem::is_empty(path("out"));
    EXPECT_TRUE(nothing);
  }
};

TEST_F(RunExport, WritesEverythingAndLeavesTheMapAsItWas) {
  write_map(varied_tiles(), {});
  const std::string before = text_of(path("map.db"));
  ASSERT_EQ(run({}), 0);
  for (const char* name :
       {"nav2.pgm", "nav2.yaml", "nav2_scale.png", "nav2_scale.yaml", "class.png", "class.pgw", "cost.png",
        "confidence.png", "height.flt", "height.hdr", "height.wld", "slope.flt", "curbs.osm"})
    EXPECT_GT(std::filesystem::file_size(out(name)), 0U) << name;
  EXPECT_EQ(text_of(path("map.db")), before);
  EXPECT_THAT(said_, HasSubstr("a map file keeps no points"));
  EXPECT_THAT(said_, HasSubstr("the map holds no curb lines"));
}

TEST_F(RunExport, OfAnEarlierSchemaLeavesOutTheHitsAndSaysSo) {
  write_map(varied_tiles(), {});
  ASSERT_EQ(run({"--only", "rasters"}), 0);
  EXPECT_TRUE(std::filesystem::exists(out("hits.png")));
  sqlite3* db = nullptr;
  sqlite3_open(path("map.db").c_str(), &db);
  sqlite3_exec(db, "PRAGMA user_version = 1", nullptr, nullptr, nullptr);
  sqlite3_close(db);
  ASSERT_EQ(run({"--only", "rasters"}), 0);
  EXPECT_FALSE(std::filesystem::exists(out("hits.png")));
  EXPECT_THAT(said_, HasSubstr("no hits"));
}

TEST_F(RunExport, SaysThatAMapIsEmpty) {
  write_map({}, {});
  expect_failure("the map is empty");
  write_map({semantic_map::tile::MapTile{.key = {5, 5},
                                         .height =
                                             [] {
                                               std::array<std::int16_t, semantic_map::tile::kCellsInTile> none{};
                                               none.fill(semantic_map::tile::MapTile::kNoHeight);
                                               return none;
                                             }()}},
            {});
  expect_failure("the map is empty");
}

TEST_F(RunExport, RefusesAMapThatNoRasterHolds) {
  semantic_map::tile::MapTile tile;
  tile.cell_class.fill(semantic_map::tile::CellClass::kRoad);
  std::vector<semantic_map::tile::MapTile> tiles(2, tile);
  tiles[0].key = {-1'000'000, 0};
  tiles[1].key = {1'000'000, 1'000'000};
  write_map(tiles, {});
  expect_failure("from edge to edge");
  EXPECT_EQ(run({"--only", "curbs,markings"}), 0) << said_;
}

TEST_F(RunExport, RefusesFilesThatAreNoMaps) {
  expect_failure("no such file");
  std::ofstream(path("map.db")) << "this is a shopping list, and quite a long one at that";
  expect_failure("not a curbstone map");
}

TEST_F(RunExport, RefusesADamagedMap) {
  write_map(varied_tiles(), {});
  std::string bytes = text_of(path("map.db"));
  for (std::size_t i = 4096; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * 37);
  std::ofstream(path("map.db"), std::ios::binary) << bytes;
  expect_failure("damaged");
}

TEST_F(RunExport, RefusesANewerSchema) {
  write_map(varied_tiles(), {});
  sqlite3* db = nullptr;
  sqlite3_open(path("map.db").c_str(), &db);
  sqlite3_exec(db, "PRAGMA user_version = 99; PRAGMA journal_mode = DELETE", nullptr, nullptr, nullptr);
  sqlite3_close(db);
  expect_failure("schema 99 is newer");
}

TEST_F(RunExport, ExplainsWrongOptions) {
  write_map(varied_tiles(), {});
  EXPECT_EQ(run({"--datum", "somewhere"}), 2);
  EXPECT_THAT(said_, HasSubstr("somewhere is not LAT,LON"));
  EXPECT_EQ(run({"--only", "cloud"}), 2);
  EXPECT_THAT(said_, HasSubstr("cloud needs --log"));
  EXPECT_EQ(run({"--only", "dxf"}), 2);
  EXPECT_EQ(run({"--unknown", "maybe"}), 2);
  EXPECT_FALSE(std::filesystem::exists(path("out")));
}

TEST_F(RunExport, SaysWhereItCannotWrite) {
  write_map(varied_tiles(), {});
  std::ofstream(path("out")) << "a file";
  EXPECT_THAT([&] { run({}); }, ThrowsMessage<std::exception>(HasSubstr("cannot be made a folder")));
}

}  // namespace
}  // namespace curbstone::map_export
