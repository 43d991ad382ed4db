#include <gmock/gmock.h>
#include <unistd.h>

#include "tests/services/semantic_map/store/map_store_fixture.hpp"

namespace curbstone::semantic_map::store {
namespace {

TEST_F(MapStoreTest, IsOfOneMomentForAReaderThatWantsThat) {
  MapStore store(path_);
  store.write({.epoch = 1, .tiles = {tile(0, 0)}, .trajectory = {pose(1'000'000)}});
  const MapReader map(path_);
  {
    const MapReader::Moment now(map);
    EXPECT_EQ(map.tiles().size(), 1U);
    store.write({.clear = true, .epoch = 2, .tiles = {tile(5, 5), tile(5, 6)}, .trajectory = {pose(9'000'000)}});
    EXPECT_EQ(map.epoch(), 1);
    ASSERT_EQ(map.trajectory().size(), 1U);
    EXPECT_EQ(map.trajectory()[0].utime, 1'000'000) << "a path of the tiles' drive";
  }
  EXPECT_EQ(map.epoch(), 2);
  EXPECT_EQ(map.tiles().size(), 2U);
}

/// As after a power cut, on a disk that is mounted to be read only.
TEST_F(MapStoreTest, OfADriveThatDidNotEndSaysWhatItNeedsWhereNothingCanBeWritten) {
  if (geteuid() != 0) GTEST_SKIP() << "root becomes another user here";
  const std::filesystem::path folder = folder_ / "usb";
  std::filesystem::create_directory(folder);
  {
    MapStore store(path_);
    store.write({.epoch = 1, .tiles = {tile(0, 0)}});
    for (const char* suffix : {"", "-wal"})
      std::filesystem::copy_file(path_.string() + suffix, (folder / "map.db").string() + suffix);
  }
  for (const auto& place : {std::filesystem::path(folder_.path()), folder})
    std::filesystem::permissions(place, std::filesystem::perms(0755));
  ASSERT_EQ(seteuid(65534), 0);
  const std::string error = error_of([&] { MapReader map(folder / "map.db"); });
  ASSERT_EQ(seteuid(0), 0);
  EXPECT_THAT(error, ::testing::HasSubstr("map.db: its drive has not ended: copy it and map.db-wal into a folder"));
  EXPECT_EQ(MapReader(folder / "map.db").tiles().size(), 1U);
}

}  // namespace
}  // namespace curbstone::semantic_map::store
