#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/services/semantic_map/store/empty_journal.hpp"
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

/// What a power cut may leave. A vehicle must not refuse to map for that, nor map into memory only.
TEST_F(MapKeeperTest, AFileThatAPowerCutHasDamagedIsSetAside) {
  {
    MapKeeper earlier(path_, 1000);
    drive(earlier, 3, kSecond, 200);
    earlier.finish({});
  }
  std::ifstream whole(path_, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(whole), {}};
  const std::string first_page_lost = std::string(8192, '\0') + bytes.substr(8192);
  for (const std::string& damaged :
       {first_page_lost, std::string(bytes.size(), '\0'), bytes.substr(0, bytes.size() / 2)}) {
    std::ofstream(path_, std::ios::binary) << damaged;
    {
      MapKeeper keeper(path_, 1000, true, UnusableFile::kWaits);
      EXPECT_NE(keeper.fault().find("was damaged, as by a power cut"), std::string::npos) << keeper.fault();
      drive(keeper, 9, 9 * kSecond, 50);
      keeper.finish({});
    }
    EXPECT_EQ(MapReader(path_).tiles().size(), 50U);
    ASSERT_EQ(kept().size(), 1U);
    EXPECT_EQ(fs::file_size(kept().front()), damaged.size()) << "nothing is thrown away";
    fs::remove(kept().front());
  }
}

/// The damage shows when the earlier drive is to be moved aside.
TEST_F(MapKeeperTest, AFileWhoseEndIsZerosIsSetAsideWhenTheNextDriveBegins) {
  {
    MapKeeper earlier(path_, 1000);
    drive(earlier, 3, kSecond, 200);
    earlier.finish({});
  }
  fs::resize_file(path_, fs::file_size(path_) / 16384 * 8192);
  const auto size = fs::file_size(path_);
  fs::resize_file(path_, 2 * size);  // zeros
  MapKeeper keeper(path_, 1000, true, UnusableFile::kWaits);
  drive(keeper, 9, 9000 * kSecond, 50);
  write_all(keeper);
  write_all(keeper);
  EXPECT_NE(keeper.fault().find("was damaged, as by a power cut"), std::string::npos) << keeper.fault();
  keeper.finish({});
  EXPECT_EQ(MapReader(path_).tiles().size(), 50U);
  ASSERT_EQ(kept().size(), 1U);
  EXPECT_EQ(fs::file_size(kept().front()), 2 * size) << "nothing is thrown away";
}

/// The owner puts everything once more, into another file.
TEST_F(MapKeeperTest, AFileThatWasOverwrittenInMidDriveIsSetAsideAndSaid) {
  MapKeeper keeper(path_, 1000, true, UnusableFile::kWaits);
  drive(keeper, 7, kSecond, 50);
  write_all(keeper);
  EXPECT_FALSE(keeper.take_lost());
  empty_journal(path_);
  std::ofstream(path_, std::ios::binary | std::ios::trunc) << "a letter";
  keeper.put(a_tile(60));
  keeper.put(a_pose(2 * kSecond));
  write_all(keeper);
  EXPECT_TRUE(keeper.take_lost());
  EXPECT_FALSE(keeper.take_lost());
  for (int x = 0; x < 50; ++x) keeper.put(a_tile(x));
  keeper.put(a_pose(kSecond));
  write_all(keeper);  // what had failed
  write_all(keeper);
  EXPECT_NE(keeper.fault().find("somebody wrote to the file during the drive"), std::string::npos) << keeper.fault();
  EXPECT_EQ(keeper.counters()["store.restored"], 1);
  EXPECT_EQ(MapReader(path_).tiles().size(), 51U);
  EXPECT_EQ(MapReader(path_).trajectory().size(), 2U);
  keeper.put(a_pose(70 * kSecond));
  EXPECT_EQ(keeper.fault(), "");
  keeper.finish({});
  EXPECT_EQ(MapReader(path_).tiles().size(), 51U);
  std::string letter;
  std::getline(std::ifstream(kept().front()), letter);
  EXPECT_EQ(letter, "a letter");
}

TEST_F(MapKeeperTest, DoesNotWaitForAFileThatIsNamedByMistakeOrWrittenByAnother) {
  std::ofstream(folder_ / "letter") << "no map at all";
  EXPECT_THROW(MapKeeper(folder_ / "letter", 100, true, UnusableFile::kWaits), WrongMapFile);
  const MapKeeper first(path_, 100);
  EXPECT_THROW(MapKeeper(path_, 100, true, UnusableFile::kWaits), WrongMapFile);
}

}  // namespace
}  // namespace curbstone::semantic_map::store
