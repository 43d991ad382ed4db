#include "services/semantic_map/store/map_store.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sqlite3.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zlib.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "services/semantic_map/store/map_store_blobs.hpp"
#include "tests/services/semantic_map/store/map_store_fixture.hpp"

namespace curbstone::semantic_map::store {
namespace {

namespace fs = std::filesystem;

TEST_F(MapStoreTest, GivesBackWhatWasWritten) {
  const std::vector<tile::CurbLine> curbs = {{0, 0.75F, false, {{1, 2, 3, 0.12F, 0, 1}, {1.1F, 2, 3, 0.11F, 0, 1}}},
                                             {7, 0.5F, true, {{-5, 2, 0, 0.03F, 1, 0}}}};
  {
    MapStore store(path_);
    store.write({.epoch = 3, .tiles = {tile(1, -2), tile(-4, 5)}, .trajectory = {pose(50'000), pose(100'000)}});
    store.write({.epoch = 3, .tiles = {tile(1, -2, 9)}, .trajectory = {pose(150'000)}, .curbs = &curbs});
    EXPECT_EQ(store.last_utime(), 150'000);
    store.close_canonical();
  }
  const MapReader map(path_);
  EXPECT_EQ(map.epoch(), 3);
  EXPECT_THAT(map.tiles(), ::testing::ElementsAre(tile(-4, 5), tile(1, -2, 9)));
  EXPECT_EQ(map.curbs(), curbs);
  const auto trajectory = map.trajectory();
  ASSERT_EQ(trajectory.size(), 3U);
  EXPECT_EQ(trajectory[2].utime, 150'000);
  EXPECT_EQ(trajectory[2].revolution, 3);
  EXPECT_TRUE(trajectory[1].T_map_base.isApprox(pose(100'000).T_map_base, 1e-12));
  EXPECT_EQ(map.integrity(), "ok");
}

TEST_F(MapStoreTest, ThatIsDeletedMeanwhileIsWrittenAgainWithAllThatItHad) {
  const std::string file = folder_ / "maps" / "map.db";
  MapStore store(file);
  store.write({.epoch = 3, .tiles = {tile(1, -2)}, .trajectory = {pose(50'000)}});
  fs::remove(file);
  store.write({.epoch = 3, .tiles = {tile(2, 2)}, .trajectory = {pose(100'000)}});
  EXPECT_EQ(MapReader(file).tiles().size(), 2U);
  fs::remove_all(folder_ / "maps");
  store.write({.epoch = 3, .tiles = {tile(3, 3)}, .trajectory = {pose(150'000)}});
  EXPECT_EQ(store.take_restored().size(), 2U);
  EXPECT_THROW(MapStore{file}, MapStoreError) << "it is locked again";
  {
    const MapReader map(file);
    EXPECT_THAT(map.tiles(), ::testing::ElementsAre(tile(1, -2), tile(2, 2), tile(3, 3)));
    EXPECT_EQ(map.trajectory().size(), 3U);
    EXPECT_EQ(map.integrity(), "ok");
  }
  store.close_canonical();
  EXPECT_EQ(MapReader(file).tiles().size(), 3U);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "maps"), {}), 1) << "nothing stays beside it";
}

TEST_F(MapStoreTest, MakesTheFolderOfTheFirstMap) {
  const MapStore store(folder_ / "site" / "today" / "map.db");
  EXPECT_TRUE(fs::exists(folder_ / "site" / "today" / "map.db"));
}

TEST_F(MapStoreTest, SameContentIsTheSameBytesHoweverManyTransactionsItTook) {
  {
    MapStore store(path_);
    store.write(
        {.epoch = 1, .tiles = {tile(0, 0), tile(1, 0), tile(0, 1)}, .trajectory = {pose(50'000), pose(100'000)}});
    store.close_canonical();
  }
  const fs::path other = folder_ / "other.db";
  {
    MapStore store(other);
    store.write({.epoch = 1, .tiles = {tile(0, 1, 5)}});
    store.write({.epoch = 1, .tiles = {tile(1, 0)}, .trajectory = {pose(50'000)}});
    store.write({.epoch = 1, .tiles = {tile(0, 1), tile(0, 0)}, .trajectory = {pose(100'000)}});
    store.close_canonical();
  }
  EXPECT_EQ(bytes(path_), bytes(other));
  EXPECT_FALSE(fs::exists(path_.string() + "-wal"));
  EXPECT_FALSE(fs::exists(path_.string() + ".canonical"));
}

TEST_F(MapStoreTest, GoesOnWithAnEarlierMapAndForgetsItOnRequest) {
  {
    MapStore store(path_);
    store.write({.epoch = 2, .tiles = {tile(0, 0)}, .trajectory = {pose(50'000)}});
    store.close_canonical();
  }
  {
    MapStore store(path_);
    EXPECT_EQ(store.epoch(), 2);
    EXPECT_EQ(store.last_utime(), 50'000);
    store.write({.epoch = 2, .tiles = {tile(1, 0)}});
  }
  EXPECT_EQ(MapReader(path_).tiles().size(), 2U);
  {
    MapStore store(path_);
    store.write({.clear = true, .epoch = 1, .tiles = {tile(5, 5)}});
    EXPECT_EQ(store.last_utime(), 0);
  }
  EXPECT_EQ(MapReader(path_).tiles().size(), 1U);
  EXPECT_TRUE(MapReader(path_).trajectory().empty());
}

TEST_F(MapStoreTest, IsReadableWhileItIsWritten) {
  MapStore store(path_);
  store.write({.epoch = 1, .tiles = {tile(0, 0)}});
  const MapReader map(path_);
  EXPECT_EQ(map.tiles().size(), 1U);
  store.write({.epoch = 1, .tiles = {tile(0, 1)}});
  EXPECT_EQ(map.tiles().size(), 2U);
}

TEST_F(MapStoreTest, GivesOneTileAtATimeAsTheFileHasItThen) {
  MapStore store(path_);
  store.write({.epoch = 1, .tiles = {tile(3, 0), tile(-1, 7)}});
  const MapReader map(path_);
  EXPECT_THAT(map.tile_keys(), ::testing::ElementsAre(TileKey{-1, 7}, TileKey{3, 0}));
  EXPECT_EQ(map.tile({3, 0}), tile(3, 0));
  EXPECT_FALSE(map.tile({3, 1}));
  store.write({.epoch = 1, .tiles = {tile(3, 0, 5)}});
  EXPECT_EQ(map.tile({3, 0}), tile(3, 0, 5));
}

TEST_F(MapStoreTest, RefusesASecondWriterWhileTheFirstLives) {
  auto first = std::make_unique<MapStore>(path_);
  EXPECT_THAT(error_of([&] { MapStore second(path_); }), ::testing::HasSubstr("another semantic map service"));
  first.reset();
  EXPECT_EQ(error_of([&] { MapStore second(path_); }), "no error");
}

TEST_F(MapStoreTest, LeavesForeignAndDamagedFilesUntouched) {
  const std::string text = "this is a shopping list, and quite a long one at that";
  write_file(path_, text);
  EXPECT_THAT(error_of([&] { MapStore store(path_); }), ::testing::HasSubstr("not a curbstone map"));
  EXPECT_THAT(error_of([&] { MapReader map(path_); }), ::testing::HasSubstr("not a curbstone map"));
  EXPECT_EQ(bytes(path_), text);
  const std::string log = "\xED\xA1\xDA\x01, and on";
  write_file(path_, log);
  EXPECT_THAT(error_of([&] { MapStore store(path_); }), ::testing::HasSubstr("not a curbstone map, but an LCM log"));
  EXPECT_THAT(error_of([&] { MapReader map(path_); }), ::testing::HasSubstr("not a curbstone map, but an LCM log"));
  EXPECT_EQ(bytes(path_), log);
  write_file(path_, "");
  EXPECT_THAT(error_of([&] { MapReader map(path_); }), ::testing::HasSubstr("not a curbstone map: it is empty"));

  fs::remove(path_);
  sqlite3* db = nullptr;
  sqlite3_open(path_.c_str(), &db);
  sqlite3_exec(db, "CREATE TABLE wine(year)", nullptr, nullptr, nullptr);
  sqlite3_close(db);
  const std::string wine = bytes(path_);
  EXPECT_THAT(error_of([&] { MapStore store(path_); }), ::testing::HasSubstr("not a curbstone map"));
  EXPECT_EQ(bytes(path_), wine);
}

TEST_F(MapStoreTest, DamagedTilesCurbsAndPosesAreSaid) {
  const std::vector<tile::CurbLine> curbs = {{0, 0.75F, false, {{1, 2, 3, 0.12F, 0, 1}, {1.1F, 2, 3, 0.11F, 0, 1}}}};
  for (const char* damage :
       {"UPDATE tiles SET x = 2000000", "UPDATE tiles SET x = -9223372036854775807 - 1",
        "UPDATE tiles SET y = 4294967298", "UPDATE tiles SET z_origin = 1e30", "UPDATE tiles SET cells = x'0102'",
        "UPDATE curbs SET confidence = 1e300", "UPDATE curbs SET points = x'01'", "UPDATE trajectory SET x = 1e300",
        "UPDATE trajectory SET qw = 0, qx = 0, qy = 0, qz = 0"}) {
    fs::remove(path_);
    {
      MapStore store(path_);
      store.write({.epoch = 1, .tiles = {tile(1, 2)}, .trajectory = {pose(50'000)}, .curbs = &curbs});
    }
    sqlite3* db = nullptr;
    sqlite3_open(path_.c_str(), &db);
    ASSERT_EQ(sqlite3_exec(db, damage, nullptr, nullptr, nullptr), SQLITE_OK) << damage;
    sqlite3_close(db);
    const auto read = [&] {
      const MapReader map(path_);
      (void)map.tiles();
      (void)map.curbs();
      (void)map.trajectory();
    };
    EXPECT_THAT(error_of(read), ::testing::HasSubstr("is damaged")) << damage;
  }
}

TEST_F(MapStoreTest, RefusesANewerSchemaAndLeavesItUntouched) {
  { MapStore store(path_); }
  sqlite3* db = nullptr;
  sqlite3_open(path_.c_str(), &db);
  sqlite3_exec(db, "PRAGMA user_version = 99; PRAGMA journal_mode = DELETE", nullptr, nullptr, nullptr);
  sqlite3_close(db);
  const std::string before = bytes(path_);
  EXPECT_THAT(error_of([&] { MapStore store(path_); }), ::testing::HasSubstr("schema 99 is newer"));
  EXPECT_THAT(error_of([&] { MapReader map(path_); }), ::testing::HasSubstr("schema 99 is newer"));
  EXPECT_EQ(bytes(path_), before);
}

TEST_F(MapStoreTest, ReadsSchemaOneAndMakesItTheNewestOnceItIsWritten) {
  tile::MapTile old = tile(2, 3);
  old.hits.fill(0);  // of which schema 1 knows nothing
  const tile::CurbLine measured{3, 0.5F, true, {{1, 2, 0, 0.1F, 1, 0}, {1, 3, 0, 0.1F, 1, 0}}};
  tile::CurbLine inferred = measured;
  inferred.inferred = true;  // of which schema 2 knows nothing
  {
    MapStore store(path_);
    const std::vector<tile::CurbLine> curbs = {measured};
    store.write({.epoch = 1, .tiles = {old}, .trajectory = {pose(50'000)}, .curbs = &curbs});
  }
  constexpr std::size_t kBytes = 6 * tile::kCellsInTile, kBytes1 = 5 * tile::kCellsInTile;
  std::vector<std::uint8_t> plain(kBytes), cells = pack_cells(old);
  uLongf size = kBytes;
  ASSERT_EQ(uncompress(plain.data(), &size, cells.data(), cells.size()), Z_OK);
  std::copy(old.confidence.begin(), old.confidence.end(), plain.begin() + 4 * tile::kCellsInTile);
  cells.resize(compressBound(kBytes1));
  size = cells.size();
  ASSERT_EQ(compress(cells.data(), &size, plain.data(), kBytes1), Z_OK);
  sqlite3* db = nullptr;
  sqlite3_open(path_.c_str(), &db);
  sqlite3_exec(db, "PRAGMA user_version = 1; ALTER TABLE curbs DROP COLUMN inferred", nullptr, nullptr, nullptr);
  sqlite3_stmt* put = nullptr;
  sqlite3_prepare_v2(db, "UPDATE tiles SET cells = ?", -1, &put, nullptr);
  sqlite3_bind_blob(put, 1, cells.data(), static_cast<int>(size), SQLITE_STATIC);
  EXPECT_EQ(sqlite3_step(put), SQLITE_DONE);
  sqlite3_finalize(put);
  sqlite3_close(db);
  {
    const MapReader map(path_);
    EXPECT_EQ(map.schema(), 1);
    EXPECT_THAT(map.tiles(), ::testing::ElementsAre(old));
    EXPECT_THAT(map.curbs(), ::testing::ElementsAre(measured));
  }
  {
    MapStore store(path_);
    EXPECT_EQ(store.last_utime(), 50'000);
    const std::vector<tile::CurbLine> curbs = {inferred};
    store.write({.epoch = 1, .tiles = {tile(9, 9)}, .curbs = &curbs});
    store.close_canonical();
  }
  const MapReader map(path_);
  EXPECT_EQ(map.schema(), kMapSchemaVersion);
  EXPECT_THAT(map.curbs(), ::testing::ElementsAre(inferred));
  EXPECT_THAT(map.tiles(), ::testing::ElementsAre(old, tile(9, 9)));
  EXPECT_EQ(map.integrity(), "ok");
}

TEST_F(MapStoreTest, SaysWhatIsMissing) {
  EXPECT_THAT(error_of([&] { MapReader map(path_); }), ::testing::HasSubstr("no such file"));
  EXPECT_FALSE(fs::exists(path_));
  EXPECT_THAT(error_of([&] { MapReader map("/tmp"); }), ::testing::HasSubstr("/tmp: is a folder, not a map"));
  EXPECT_THAT(error_of([&] { MapStore store("/proc/no/map.db"); }), ::testing::HasSubstr("No such file or directory"));
}

TEST_F(MapStoreTest, SurvivesKillAtAnyMomentWithNothingAcknowledgedLost) {
  for (int round = 0; round < 5; ++round) {
    fs::remove(path_);
    int acknowledged[2];
    ASSERT_EQ(pipe(acknowledged), 0);
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      MapStore store(path_);
      for (std::int32_t i = 0; i < 100'000; ++i) {
        store.write({.epoch = 1, .tiles = {tile(i, 0), tile(i, 1)}, .trajectory = {pose(50'000 * (i + 1))}});
        if (write(acknowledged[1], &i, sizeof i) != sizeof i) _exit(1);
      }
      _exit(0);
    }
    close(acknowledged[1]);
    std::int32_t last = -1;
    std::int32_t i = 0;
    while (last < 5 + 7 * round && read(acknowledged[0], &i, sizeof i) == sizeof i) last = i;
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    while (read(acknowledged[0], &i, sizeof i) == sizeof i) last = i;
    close(acknowledged[0]);

    MapStore again(path_);  // the lock went with the process
    const MapReader map(path_);
    EXPECT_EQ(map.integrity(), "ok");
    const auto tiles = map.tiles();
    EXPECT_GE(tiles.size(), 2U * static_cast<std::size_t>(last + 1));
    EXPECT_EQ(tiles.size(), 2 * map.trajectory().size()) << "a transaction is there as a whole or not at all";
  }
}

TEST_F(MapStoreTest, AFullDiskLosesNothingThatWasWrittenBefore) {
  // In a child, as a limit on the file size stands for the full disk.
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    signal(SIGXFSZ, SIG_IGN);
    MapStore store(path_);
    store.write({.epoch = 1, .tiles = {tile(0, 0)}});
    const rlimit small{150'000, RLIM_INFINITY};
    setrlimit(RLIMIT_FSIZE, &small);
    std::vector<tile::MapTile> many;
    for (std::int32_t i = 0; i < 200; ++i) many.push_back(tile(i, 1));
    const std::string error = error_of([&] { store.write({.epoch = 1, .tiles = many}); });
    if (error == "no error") _exit(1);
    const rlimit large{RLIM_INFINITY, RLIM_INFINITY};
    setrlimit(RLIMIT_FSIZE, &large);
    if (MapReader(path_).tiles().size() != 1) _exit(2);
    if (error_of([&] { store.write({.epoch = 1, .tiles = many}); }) != "no error") _exit(3);
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_EQ(MapReader(path_).tiles().size(), 201U);
}

}  // namespace
}  // namespace curbstone::semantic_map::store
