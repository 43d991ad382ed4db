#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/services/semantic_map/store/empty_journal.hpp"
#include "tests/services/semantic_map/store/map_store_fixture.hpp"

/// @file
/// MapStore: what others do to its files during a drive.

namespace curbstone::semantic_map::store {
namespace {

namespace fs = std::filesystem;

class MapStoreOthersTest : public MapStoreTest {
 protected:
  void SetUp() override { store_.write({.epoch = 3, .tiles = {tile(1, -2)}, .trajectory = {pose(50'000)}}); }
  void write_another() { store_.write({.epoch = 3, .tiles = {tile(2, 2)}, .trajectory = {pose(100'000)}}); }
  [[nodiscard]] std::vector<std::string> beside() const {
    std::vector<std::string> names;
    for (const auto& file : fs::directory_iterator(folder_.path())) {
      if (!file.path().filename().string().starts_with("map.db")) names.push_back(file.path().filename());
    }
    return names;
  }

  MapStore store_{path_};
};

TEST_F(MapStoreOthersTest, AFileThatWasPutInItsPlaceIsKeptBesideIt) {
  const fs::path other = folder_ / "other.db";
  {
    MapStore map(other);
    map.write({.epoch = 9, .tiles = {tile(7, 7)}, .trajectory = {pose(9'000'000)}});
    map.close_canonical();
  }
  const std::string bytes_of_other = bytes(other);
  fs::rename(other, path_);
  write_another();
  EXPECT_THAT(store_.take_restored(),
              ::testing::ElementsAre(::testing::HasSubstr("another file was put in its place")));
  EXPECT_EQ(MapReader(path_).tiles().size(), 2U);
  EXPECT_EQ(MapReader(path_).integrity(), "ok");
  ASSERT_THAT(beside(), ::testing::ElementsAre(::testing::StartsWith("map-replaced-")));
  EXPECT_EQ(bytes(folder_ / beside().front()), bytes_of_other);
  EXPECT_THROW(MapStore{path_}, MapStoreError) << "it is locked again";
  store_.close_canonical();
  EXPECT_EQ(MapReader(path_).trajectory().size(), 2U);
}

/// `mv` of all files of a map that has not ended.
TEST_F(MapStoreOthersTest, AFileThatWasPutInItsPlaceKeepsItsJournal) {
  const fs::path other = folder_ / "other.db";
  {
    MapStore map(other);
    map.write({.epoch = 9, .tiles = {tile(7, 7)}, .trajectory = {pose(9'000'000)}});
    for (const char* part : {"", "-wal"})
      fs::copy_file(other.string() + part, folder_ / ("killed.db" + std::string(part)));
  }
  for (const char* part : {"", "-wal"}) fs::rename(folder_ / ("killed.db" + std::string(part)), path_.string() + part);
  fs::remove(other);
  write_another();
  EXPECT_EQ(MapReader(path_).tiles().size(), 2U);
  std::string aside;
  for (const std::string& name : beside()) aside = name.ends_with(".db") ? name : aside;
  EXPECT_EQ(MapReader(folder_ / aside).tiles().size(), 1U);
  EXPECT_EQ(MapReader(folder_ / aside).epoch(), 9);
}

TEST_F(MapStoreOthersTest, AFolderThatWasPutInItsPlaceIsKeptBesideIt) {
  fs::remove(path_);
  fs::create_directory(path_);
  write_another();
  EXPECT_EQ(MapReader(path_).tiles().size(), 2U);
  EXPECT_THAT(beside(), ::testing::ElementsAre(::testing::StartsWith("map-replaced-")));
}

/// The second one was started after somebody had deleted the files.
TEST_F(MapStoreOthersTest, AFileThatAnotherServiceWritesIsLeftToIt) {
  for (const char* part : {"", "-wal", "-shm"}) fs::remove(path_.string() + part);
  {
    MapStore second(path_);
    second.write({.epoch = 9, .tiles = {tile(7, 7)}});
    EXPECT_THROW(write_another(), MapStoreError);
    second.write({.epoch = 9, .tiles = {tile(8, 8)}});
    EXPECT_EQ(MapReader(path_).tiles().size(), 2U);
  }
  write_another();
  EXPECT_EQ(MapReader(path_).tiles().size(), 2U);
  EXPECT_EQ(MapReader(path_).epoch(), 3);
}

/// Without its name the journal ends with the process, and a reader finds a map that does not fit it.
TEST_F(MapStoreOthersTest, AJournalThatWasDeletedIsAFileThatWasDeleted) {
  for (const char* part : {"-wal", "-shm"}) {
    fs::remove(path_.string() + part);
    write_another();
    EXPECT_EQ(MapReader(path_).tiles().size(), 2U);
    EXPECT_EQ(MapReader(path_).integrity(), "ok");
  }
  EXPECT_EQ(store_.take_restored().size(), 2U);
}

/// `cp other.db map.db`, `> map.db`, a copy that is still under way: the file is the same, and is not the map.
TEST_F(MapStoreOthersTest, AFileThatWasOverwrittenIsDamaged) {
  const fs::path other = folder_ / "other.db";
  {
    MapStore map(other);
    map.write({.epoch = 3, .tiles = {tile(7, 7)}, .trajectory = {pose(9'000'000)}});
    map.close_canonical();
  }
  const std::string whole = bytes(other);
  for (const std::string& content : {whole, std::string(), whole.substr(0, whole.size() / 2), std::string("letter")}) {
    const fs::path file = folder_ / "overwritten.db";
    fs::remove(file);
    MapStore store(file);
    store.write({.epoch = 3, .tiles = {tile(1, -2)}, .trajectory = {pose(50'000)}});
    empty_journal(file);
    write_file(file, content);
    EXPECT_THROW(store.write({.epoch = 3, .tiles = {tile(2, 2)}}), DamagedMapFile) << content.size();
    EXPECT_EQ(bytes(file), content) << "it stays as it is";
  }
}

/// As long as the journal has all pages, it is the map whatever the file is.
TEST_F(MapStoreOthersTest, AFileThatWasOverwrittenWhileAllIsInTheJournalIsTheMap) {
  write_file(path_, "letter");
  write_another();
  store_.close_canonical();
  EXPECT_EQ(MapReader(path_).integrity(), "ok");
  EXPECT_EQ(MapReader(path_).tiles().size(), 2U);
}

TEST_F(MapStoreOthersTest, AFileThatWasOnlyTouchedOrTidiedIsTheMap) {
  fs::last_write_time(path_, fs::file_time_type::clock::now() + std::chrono::hours(1));
  write_another();
  empty_journal(path_);
  store_.write({.epoch = 3, .tiles = {tile(3, 3)}, .trajectory = {pose(150'000)}});
  EXPECT_TRUE(store_.take_restored().empty());
  EXPECT_EQ(MapReader(path_).tiles().size(), 3U);
}

}  // namespace
}  // namespace curbstone::semantic_map::store
