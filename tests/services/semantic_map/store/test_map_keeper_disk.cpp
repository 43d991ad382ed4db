#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "tests/services/semantic_map/store/map_keeper_fixture.hpp"

/// @file
/// MapKeeper: files that vanish, and files that cannot be used at the start.

namespace curbstone::semantic_map::store {
namespace {

TEST_F(MapKeeperTest, SaysForAMinuteThatTheFileWasDeletedAndWrittenAgain) {
  MapKeeper keeper(path_, 100);
  drive(keeper, 7, kSecond, 50);
  write_all(keeper);
  fs::remove(path_);
  keeper.put(a_pose(2 * kSecond));
  write_all(keeper);
  EXPECT_EQ(keeper.counters()["store.restored"], 1);
  EXPECT_EQ(keeper.counters()["faults.store"], 0);
  EXPECT_NE(keeper.fault().find("the file was deleted during the drive"), std::string::npos) << keeper.fault();
  EXPECT_EQ(MapReader(path_).tiles().size(), 50U);
  keeper.put(a_pose(70 * kSecond));
  EXPECT_EQ(keeper.fault(), "");
}

/// A vehicle drives, and shows the map, though the disk of the map is not there yet.
TEST_F(MapKeeperTest, AFileThatCannotBeUsedIsAFaultAndIsTriedAgain) {
  const fs::path disk = folder_ / "disk";
  std::ofstream(disk) << "in the way";
  EXPECT_THROW(MapKeeper(disk / "map.db", 100), MapStoreError);
  MapKeeper keeper(disk / "map.db", 100, true, UnusableFile::kWaits);
  EXPECT_NE(keeper.fault().find("the map is kept in memory only: "), std::string::npos) << keeper.fault();
  drive(keeper, 7, kSecond, 50);
  keeper.write();
  EXPECT_TRUE(keeper.failing());
  fs::remove(disk);
  write_all(keeper);
  EXPECT_EQ(keeper.fault(), "");
  EXPECT_EQ(MapReader(disk / "map.db").tiles().size(), 50U);
  keeper.finish({});
  EXPECT_EQ(MapReader(disk / "map.db").trajectory().size(), 1U);
}

TEST_F(MapKeeperTest, AFileThatComesLaterKeepsItsEarlierDrive) {
  const fs::path stored = folder_ / "stored.db", disk = folder_ / "disk";
  {
    MapKeeper earlier(stored, 100);
    drive(earlier, 3, kSecond, 20);
    earlier.finish({});
  }
  std::ofstream(disk) << "in the way";
  MapKeeper keeper(disk / "map.db", 100, true, UnusableFile::kWaits);
  drive(keeper, 9000, 9000 * kSecond, 50);
  fs::remove(disk);
  fs::create_directory(disk);
  fs::rename(stored, disk / "map.db");
  write_all(keeper);
  keeper.finish({});
  std::size_t earlier = 0;
  for (const auto& file : fs::directory_iterator(disk)) {
    if (file.path().filename() != "map.db") earlier += MapReader(file.path()).tiles().size();
  }
  EXPECT_EQ(earlier, 20U);
  EXPECT_EQ(MapReader(disk / "map.db").tiles().size(), 50U);
}

TEST_F(MapKeeperTest, DoesNotWaitForAFileThatIsNamedByMistakeOrWrittenByAnother) {
  std::ofstream(folder_ / "letter") << "no map at all";
  EXPECT_THROW(MapKeeper(folder_ / "letter", 100, true, UnusableFile::kWaits), WrongMapFile);
  const MapKeeper first(path_, 100);
  EXPECT_THROW(MapKeeper(path_, 100, true, UnusableFile::kWaits), WrongMapFile);
}

}  // namespace
}  // namespace curbstone::semantic_map::store
