#include "services/semantic_map/store/map_keeper.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/services/semantic_map/store/map_keeper_fixture.hpp"

namespace curbstone::semantic_map::store {
namespace {

TEST_F(MapKeeperTest, WhatWasPutIsWrittenBesideItsOwner) {
  MapKeeper keeper(path_, 100);
  keeper.start(7, kSecond);
  for (int x = 0; x < 50; ++x) keeper.put(a_tile(x));
  keeper.put(a_pose(kSecond));
  write_all(keeper);
  EXPECT_GE(keeper.counters()["store.transactions"], 1);
  EXPECT_EQ(keeper.counters()["store.tiles"], 50);
  EXPECT_EQ(keeper.fault(), "");
  const MapReader map(path_);
  EXPECT_EQ(map.epoch(), 7);
  EXPECT_EQ(map.tiles().size(), 50U);
  EXPECT_EQ(map.trajectory().size(), 1U);
}

TEST_F(MapKeeperTest, WhatComesWhileItWritesIsInTheNextTransaction) {
  MapKeeper keeper(path_, 1000);
  keeper.start(7, kSecond);
  for (int round = 0; round < 20; ++round) {
    for (int x = 0; x < 40; ++x)
      keeper.put(a_tile(x, round % 2 == 0 ? tile::CellClass::kRoad : tile::CellClass::kCurb));
    keeper.put(a_pose(kSecond + round));
    keeper.write();  // mostly busy
  }
  keeper.finish({});
  const MapReader map(path_);
  const auto tiles = map.tiles();
  ASSERT_EQ(tiles.size(), 40U);
  for (const tile::MapTile& tile : tiles) EXPECT_EQ(tile.cell_class[0], tile::CellClass::kCurb) << "the newest";
  EXPECT_EQ(map.trajectory().size(), 20U);
}

/// The larger the map is the longer it takes: no tile should wait for it.
TEST_F(MapKeeperTest, LinesAreLinkedInTheThreadThatWrites) {
  MapKeeper keeper(path_, 100);
  keeper.start(7, kSecond);
  keeper.put(a_pose(kSecond));
  std::thread::id linked_in;
  keeper.put([&] {
    linked_in = std::this_thread::get_id();
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    return tile::MapLines{{tile::CurbLine{.points = {{1, 2, 3, 0.1F, 0, 1}, {2, 2, 3, 0.1F, 0, 1}}}}, {}};
  });
  write_all(keeper);
  EXPECT_NE(linked_in, std::thread::id());
  EXPECT_NE(linked_in, std::this_thread::get_id());
  EXPECT_GE(keeper.linking_took(), 2'000);
  ASSERT_EQ(MapReader(path_).curbs().size(), 1U);
  keeper.put([]() -> tile::MapLines { throw std::logic_error("the lines that finish() is given count"); });
  keeper.finish({});
  EXPECT_TRUE(MapReader(path_).curbs().empty());
}

TEST_F(MapKeeperTest, AnotherDriveMakesTheEarlierOneAFileBeside) {
  {
    MapKeeper keeper(path_, 1000);
    drive(keeper, 7, kSecond, 200);
    keeper.finish({});
  }
  MapKeeper keeper(path_, 1000);
  drive(keeper, 8, 100 * kSecond, 3);
  EXPECT_EQ(keeper.fault(), "") << "that is how a day begins";
  keeper.finish({});
  const MapReader map(path_);
  EXPECT_EQ(map.epoch(), 8);
  EXPECT_EQ(map.tiles().size(), 3U);
  EXPECT_EQ(map.trajectory().size(), 1U);
  ASSERT_EQ(kept(), std::vector<fs::path>{folder_ / "map-19700101T000001Z.db"});
  const MapReader earlier(kept().front());
  EXPECT_EQ(earlier.epoch(), 7);
  EXPECT_EQ(earlier.tiles().size(), 200U);
  EXPECT_EQ(earlier.trajectory().size(), 1U);
}

TEST_F(MapKeeperTest, DrivesThatBeginAtTheSameTimeOfABrokenClockAreAllKept) {
  for (int day = 0; day < 4; ++day) {
    MapKeeper keeper(path_, 1000);
    drive(keeper, 7 + day, kSecond, 10 + day);
    keeper.finish({});
  }
  const std::vector<fs::path> wanted = {folder_ / "map-19700101T000001Z-2.db", folder_ / "map-19700101T000001Z-3.db",
                                        folder_ / "map-19700101T000001Z.db"};
  EXPECT_EQ(kept(), wanted);
}

TEST_F(MapKeeperTest, AMapBegunAnewInMidDriveLosesNothingAndIsAFault) {
  MapKeeper keeper(path_, 1000);
  drive(keeper, 7, kSecond, 200);  // not written yet when the mapper dies
  drive(keeper, 8, 2 * kSecond, 3);
  keeper.put(a_pose(8 * kSecond));
  EXPECT_NE(keeper.fault().find("map-19700101T000001Z.db"), std::string::npos) << keeper.fault();
  keeper.finish({});
  EXPECT_EQ(MapReader(path_).tiles().size(), 3U);
  ASSERT_EQ(kept().size(), 1U);
  EXPECT_EQ(MapReader(kept().front()).tiles().size(), 200U);
}

TEST_F(MapKeeperTest, ADriveThatIsCorrectedAsAWholeIsOneMap) {
  MapKeeper keeper(path_, 1000);
  drive(keeper, 7, kSecond, 200);
  for (int closure = 0; closure < 3; ++closure) {
    drive(keeper, 8 + closure, (10 + closure) * kSecond, 190);
    keeper.corrected_from(kSecond);
    keeper.put(a_pose(kSecond));
    write_all(keeper);
    EXPECT_EQ(keeper.fault(), "");
    EXPECT_EQ(MapReader(kept().front()).tiles().size(), closure == 0 ? 200U : 190U) << "until all has come again";
  }
  keeper.finish({});
  EXPECT_EQ(MapReader(path_).tiles().size(), 190U);
  EXPECT_TRUE(kept().empty());
}

TEST_F(MapKeeperTest, WaitsForTheCorrectionOfTheDriveBeforeItCallsItsNewEpochAFault) {
  MapKeeper keeper(path_, 1000);
  drive(keeper, 7, 100 * kSecond, 20);
  keeper.put(a_pose(110 * kSecond));
  drive(keeper, 8, 111 * kSecond, 20);
  for (int second = 0; second <= 5; ++second) {
    keeper.put(a_pose((111 + second) * kSecond));
    EXPECT_EQ(keeper.fault(), "") << second << " s: MAP_TRAJECTORY is on its way";
  }
  keeper.put(a_pose(117 * kSecond));
  EXPECT_NE(keeper.fault().find("mid-drive"), std::string::npos) << "none came: " << keeper.fault();
  keeper.corrected_from(100 * kSecond);
  EXPECT_EQ(keeper.fault(), "") << "late, but the same drive";
}

TEST_F(MapKeeperTest, AFileThatACorrectionSupersededGoesAlsoIfTheServiceWasKilledMeanwhile) {
  die_in_a_correction(190);
  ASSERT_EQ(kept().size(), 1U);
  const fs::path file = kept().front();
  {
    MapKeeper successor(path_, 1000);
    drive(successor, 8, 11 * kSecond, 195);
    write_all(successor);
    EXPECT_TRUE(fs::exists(file)) << "until all tiles have come again";
    successor.finish({});
  }
  EXPECT_TRUE(kept().empty());
  EXPECT_EQ(MapReader(path_).tiles().size(), 195U);
  EXPECT_EQ(MapStore(path_).superseded(), "");
}

TEST_F(MapKeeperTest, AFileThatWasSupersededStaysIfAnotherDriveBeginsBeforeAllCameAgain) {
  die_in_a_correction(19);
  MapKeeper tomorrow(path_, 1000);
  drive(tomorrow, 9, 90'000 * kSecond, 3);
  tomorrow.finish({});
  EXPECT_EQ(kept().size(), 2U) << "the whole drive as it was, and what had come of its correction";
}

/// The journal of the drive is in memory: it outlives all processes, not a power cut.
TEST_F(MapKeeperTest, ADriveWhoseMapperWasKilledAlongWithTheServiceIsOneMap) {
  die_in_a_correction(190);
  {
    MapKeeper successor(path_, 1000);
    drive(successor, 9, 12 * kSecond, 200);
    successor.corrected_from(10 * kSecond);
    EXPECT_EQ(successor.fault(), "");
    write_all(successor);
    const auto maps = kept();
    EXPECT_EQ(std::ranges::count(maps, ".db", [](const fs::path& file) { return file.extension(); }), 1)
        << "until all tiles have come again";
    successor.finish({});
  }
  EXPECT_TRUE(kept().empty());
  EXPECT_EQ(MapReader(path_).tiles().size(), 200U);
}

TEST_F(MapKeeperTest, ADriveThatBeganAtNearlyTheSameTimeOfABrokenClockIsAnother) {
  for (int day = 0; day < 2; ++day) {
    MapKeeper keeper(path_, 1000);
    drive(keeper, 7 + day, kSecond + day, 10);
    keeper.corrected_from(kSecond + day);
    keeper.finish({});
  }
  EXPECT_EQ(kept().size(), 1U);
}

TEST_F(MapKeeperTest, RemovesNoFileThatAMapFromElsewhereNames) {
  const fs::path other = folder_ / "holiday.db";
  std::ofstream(other) << "photos";
  {
    MapStore store(path_);
    store.write({.epoch = 7, .trajectory = {a_pose(kSecond)}, .superseded = other.string()});
  }
  MapKeeper keeper(path_, 1000);
  drive(keeper, 7, 2 * kSecond, 3);
  keeper.finish({});
  EXPECT_TRUE(fs::exists(other));
}

TEST_F(MapKeeperTest, ReplacesTheEarlierDriveWhereThatIsWanted) {
  for (int run = 0; run < 2; ++run) {
    MapKeeper keeper(path_, 1000, false);
    drive(keeper, 7 + run, kSecond, 10);
    keeper.finish({});
  }
  EXPECT_TRUE(kept().empty());
}

TEST_F(MapKeeperTest, WhileTheDiskIsFullTheNewestOfEachTileIsKeptUpToABound) {
  // In a child, as a limit on the file size stands for the full disk.
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    signal(SIGXFSZ, SIG_IGN);
    MapKeeper keeper(path_, 400);
    keeper.start(7, kSecond);
    keeper.put(a_pose(kSecond));
    write_all(keeper);
    const rlimit small{100'000, RLIM_INFINITY};
    setrlimit(RLIMIT_FSIZE, &small);
    for (int x = 0; x < 300; ++x) keeper.put(a_tile(x, tile::CellClass::kRoad, 13));
    keeper.put(a_pose(2 * kSecond));
    write_all(keeper);
    if (keeper.fault().empty()) _exit(1);
    for (int x = 0; x < 300; x += 2) keeper.put(a_tile(x, tile::CellClass::kWall, 17));
    for (int x = 300; x < 450; ++x) keeper.put(a_tile(x, tile::CellClass::kRoad, 13));
    keeper.put(a_pose(3 * kSecond));
    write_all(keeper);
    if (keeper.counters()["faults.store"] != 2 || keeper.counters()["dropped.unstored_tiles"] != 50) _exit(2);
    const rlimit large{RLIM_INFINITY, RLIM_INFINITY};
    setrlimit(RLIMIT_FSIZE, &large);
    write_all(keeper);
    if (!keeper.fault().empty()) _exit(3);
    keeper.finish({});
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 0);
  const MapReader map(path_);
  const auto tiles = map.tiles();
  ASSERT_EQ(tiles.size(), 400U);
  for (int x = 0; x < 300; ++x) {
    EXPECT_EQ(tiles[static_cast<std::size_t>(x)].cell_class[0],
              x % 2 == 0 ? tile::CellClass::kWall : tile::CellClass::kRoad);
  }
  EXPECT_EQ(map.trajectory().size(), 3U);
}

}  // namespace
}  // namespace curbstone::semantic_map::store
