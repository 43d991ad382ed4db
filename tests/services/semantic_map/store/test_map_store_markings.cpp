#include <gmock/gmock.h>
#include <sqlite3.h>

#include <filesystem>

#include "services/semantic_map/store/map_store.hpp"
#include "tests/services/semantic_map/store/map_store_fixture.hpp"

namespace curbstone::semantic_map::store {
namespace {

namespace fs = std::filesystem;

std::vector<tile::MarkingLine> some_markings() {
  tile::MarkingLine dashed{.id = 0,
                           .type = tile::MarkingType::kDashed,
                           .confidence = 0.9F,
                           .width = 0.12F,
                           .dash = 3,
                           .gap = 6,
                           .points = {{0, 0, 1, true}, {3, 0, 1, false}, {9, 0, 1, true}, {12, 0, 1, false}}};
  tile::MarkingLine stop{.id = 1, .type = tile::MarkingType::kStopLine, .width = 0.4F, .points = {{5, -3, 1, true}}};
  return {dashed, stop};
}

TEST_F(MapStoreTest, MarkingsComeBackAsTheyWere) {
  const std::vector<tile::MarkingLine> markings = some_markings();
  MapStore store(path_);
  store.write({.epoch = 1, .markings = &markings});
  EXPECT_EQ(MapReader(path_).markings(), markings);
  store.write({.epoch = 1, .tiles = {tile(1, 1)}});
  EXPECT_EQ(MapReader(path_).markings(), markings);
  store.write({.clear = true, .epoch = 2});
  EXPECT_TRUE(MapReader(path_).markings().empty());
}

TEST_F(MapStoreTest, SchemaTwoHasNoMarkingsAndIsMadeThreeOnceItIsWritten) {
  { MapStore store(path_); }
  sqlite3* db = nullptr;
  sqlite3_open(path_.c_str(), &db);
  sqlite3_exec(db, "DROP TABLE markings; PRAGMA user_version = 2", nullptr, nullptr, nullptr);
  sqlite3_close(db);
  EXPECT_TRUE(MapReader(path_).markings().empty());
  EXPECT_EQ(MapReader(path_).schema(), 2);
  const std::vector<tile::MarkingLine> markings = some_markings();
  {
    MapStore store(path_);
    store.write({.epoch = 1, .markings = &markings});
  }
  EXPECT_EQ(MapReader(path_).schema(), 3);
  EXPECT_EQ(MapReader(path_).markings(), markings);
}

TEST_F(MapStoreTest, DamagedMarkingsAreSaid) {
  for (const char* damage : {"UPDATE markings SET type = 17", "UPDATE markings SET points = x'0102'",
                             "UPDATE markings SET points = x'0000c07f000000000000000000000000'"}) {
    fs::remove(path_);
    const std::vector<tile::MarkingLine> markings = some_markings();
    {
      MapStore store(path_);
      store.write({.epoch = 1, .markings = &markings});
    }
    sqlite3* db = nullptr;
    sqlite3_open(path_.c_str(), &db);
    sqlite3_exec(db, damage, nullptr, nullptr, nullptr);
    sqlite3_close(db);
    EXPECT_THAT(error_of([&] { (void)MapReader(path_).markings(); }), ::testing::HasSubstr("is damaged")) << damage;
  }
}

}  // namespace
}  // namespace curbstone::semantic_map::store
