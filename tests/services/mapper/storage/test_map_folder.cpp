#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <random>

#include "services/mapper/storage/map_folder.hpp"
#include "services/mapper/storage/map_folder_rules.hpp"
#include "tests/services/mapper/storage/saved_map_fixture.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::mapper::storage {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

TEST(MapFolder, LoadsWhatWasSavedBitForBit) {
  const auto scratch = test::TemporaryFolder::in_memory();
  const SavedMap map = random_map(1, 50, 20);
  save_map(map, scratch / "town");
  EXPECT_TRUE(equal(load_map(scratch / "town"), map));
  EXPECT_THAT(names_in(scratch / "."), ::testing::ElementsAre("town"));
  EXPECT_THAT(names_in(scratch / "town"),
              ::testing::ElementsAre("graph.csv", "map.yaml", "nodes", "nodes.csv", "rings.csv", "tiles", "tiles.csv"));
}

TEST(MapFolder, OfAnEarlierVersionHasNoScaleOfIntensities) {
  const auto scratch = test::TemporaryFolder::in_memory();
  SavedMap map = random_map(1, 4, 2);
  save_map(map, scratch / "town");
  std::string head = bytes_of(scratch / "town/map.yaml");
  for (const char* line : {"rings: 2\n", "ring_scans: 640\n"}) head.erase(head.find(line), std::string(line).size());
  put_bytes(scratch / "town/map.yaml", head);
  fs::remove(scratch / "town/rings.csv");
  map.rings = {};
  EXPECT_TRUE(equal(load_map(scratch / "town"), map));
  save_map(map, scratch / "town");  // and it is a map that may be replaced
}

TEST(MapFolder, AnEmptyMapIsAMap) {
  const auto scratch = test::TemporaryFolder::in_memory();
  SavedMap map;
  map.tiles.push_back({.key = {3, -4}, .z_origin = 2, .utime = 0, .points = {}});  // seen, but nothing settled yet
  save_map(map, scratch / "empty");
  EXPECT_TRUE(equal(load_map(scratch / "empty"), map));
}

TEST(MapFolder, EveryStepOfTheLatticeSurvivesFloat32UpTo32Kilometres) {
  const auto scratch = test::TemporaryFolder::in_memory();
  for (const int key : {0, 1, -1, 5461, 10'921, -10'921}) {
    SavedMap map;
    SavedTile tile{.key = {key, -key}, .z_origin = 32'700, .utime = 5, .points = {}};
    for (int i = 0; i < 60; ++i) {
      for (int k = 0; k < 25; ++k) {  // each of the 1500 steps once, in voxels of their own
        tile.points.push_back({static_cast<std::int16_t>(25 * i + k), static_cast<std::int16_t>(25 * i + 24 - k),
                               static_cast<std::int16_t>(25 * k - 32'768 + 8 + i % 17), 7});
      }
    }
    map.tiles.push_back(tile);
    save_map(map, scratch / "far");
    EXPECT_TRUE(equal(load_map(scratch / "far"), map)) << key;
  }
}

TEST(MapFolder, ReplacesAnOldMapAndLeavesNothingOfIt) {
  const auto scratch = test::TemporaryFolder::in_memory();
  const SavedMap before = random_map(1, 30, 5), after = random_map(2, 4, 2);
  save_map(before, scratch / "town");
  save_map(after, scratch / "town/");  // a slash at the end is the same folder
  EXPECT_TRUE(equal(load_map(scratch / "town"), after));
  EXPECT_EQ(names_in(scratch / "town/tiles").size(), 4U);
  EXPECT_THAT(names_in(scratch / "."), ::testing::ElementsAre("town"));
}

TEST(MapFolder, ALinkToAMapStaysALink) {
  const auto scratch = test::TemporaryFolder::in_memory();
  save_map(random_map(1, 3, 1), scratch / "2026-11-21");
  fs::create_directory_symlink("2026-11-21", scratch / "latest");
  const SavedMap map = random_map(2, 2, 2);
  save_map(map, scratch / "latest");
  EXPECT_TRUE(fs::is_symlink(scratch / "latest"));
  EXPECT_TRUE(equal(load_map(scratch / "2026-11-21"), map));
}

TEST(MapFolder, AFolderOfSomeoneElseIsLeftAlone) {
  const auto scratch = test::TemporaryFolder::in_memory();
  const SavedMap map = random_map(1, 2, 2);
  for (const std::string name :
       {"home/thesis.odt", "nav2/map.pgm", "mine/tiles/bathroom.png", "town.partial/thesis.odt"}) {
    fs::create_directories((scratch / name).parent_path());
    put_bytes(scratch / name, "years of work");
  }
  put_bytes(scratch / "nav2/map.yaml", "image: map.pgm");
  put_bytes(scratch / "file", "a file");
  for (const std::string name : {"home", "nav2", "mine", "town", "file"}) {
    EXPECT_THROW(save_map(map, scratch / name), MapFolderError) << name;
  }
  EXPECT_EQ(bytes_of(scratch / "home/thesis.odt"), "years of work");
  EXPECT_EQ(bytes_of(scratch / "town.partial/thesis.odt"), "years of work");
  EXPECT_EQ(bytes_of(scratch / "mine/tiles/bathroom.png"), "years of work");
}

TEST(MapFolder, WhatCannotBeWrittenIsSaidAndTheOldMapStays) {
  const auto scratch = test::TemporaryFolder::in_memory();
  const SavedMap map = random_map(1, 2, 2);
  save_map(map, scratch / "town");
  put_bytes(scratch / "file", "");
  EXPECT_THROW(save_map(map, scratch / "file/town"), MapFolderError);
  SavedMap bad = random_map(2, 3, 3);
  bad.tiles[2].points[5].x = 1500;
  try {
    save_map(bad, scratch / "town");
    FAIL();
  } catch (const MapFolderError& error) {
    EXPECT_THAT(error.what(), HasSubstr("point 5 lies outside its tile"));
  }
  EXPECT_TRUE(equal(load_map(scratch / "town"), map));
  EXPECT_FALSE(fs::exists(scratch / "town.partial"));
}

TEST(MapFolder, RefusesToSaveWhatItWouldNotLoad) {
  const auto scratch = test::TemporaryFolder::in_memory();
  const auto refused = [&](const char* why, auto&& spoil) {
    SavedMap map = random_map(1, 3, 3);
    spoil(map);
    try {
      save_map(map, scratch / "bad");
      ADD_FAILURE() << why;
    } catch (const MapFolderError& error) {
      EXPECT_THAT(error.what(), HasSubstr(why));
    }
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  refused("voxel 0.007", [](SavedMap& m) { m.voxel = 0.007; });
  refused("voxel nan", [&](SavedMap& m) { m.voxel = nan; });
  refused("epoch -1", [](SavedMap& m) { m.epoch = -1; });
  refused("is there twice", [](SavedMap& m) { m.tiles[2].key = m.tiles[0].key; });
  refused("32 km", [](SavedMap& m) { m.tiles[0].key.x = -10'922; });
  refused("z_origin", [](SavedMap& m) { m.tiles[0].z_origin = 1'000'000; });
  refused("another's voxel", [](SavedMap& m) { m.tiles[1].points.push_back(m.tiles[1].points[0]); });
  refused("row 1: is no pose", [&](SavedMap& m) { m.nodes[1].T_map_base.translation().x() = nan; });
  refused("row 0: is no pose", [](SavedMap& m) { m.nodes[0].T_map_base.linear() *= 2.0; });
  refused("2 to 3 of 3 nodes", [](SavedMap& m) { m.edges[0].from = 2, m.edges[0].to = 3; });
  refused("information", [&](SavedMap& m) { m.edges[1].information(2, 3) = nan; });
  EXPECT_FALSE(fs::exists(scratch / "bad"));
}

TEST(MapFolder, KilledAtAnyMomentOneOfTheTwoMapsIsWhole) {
  const auto scratch = test::TemporaryFolder::in_memory();
  const SavedMap maps[] = {random_map(1, 60, 10), random_map(2, 40, 20)};
  const fs::path folder = scratch / "town";
  save_map(maps[0], folder);
  std::mt19937 random(3);
  for (int round = 0; round < 30; ++round) {
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      for (int i = 1;; ++i) save_map(maps[i % 2], folder);
    }
    usleep(static_cast<useconds_t>(1000 + random() % 40000));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    const SavedMap found = load_map(folder);
    ASSERT_TRUE(equal(found, maps[0]) || equal(found, maps[1])) << round;
  }
  save_map(maps[1], folder);  // over whatever the last one left
  EXPECT_TRUE(equal(load_map(folder), maps[1]));
  EXPECT_THAT(names_in(scratch / "."), ::testing::ElementsAre("town"));
}

/// A map that grows: each time a few tiles are other ones, and there are more nodes.
SavedMap grown(int times) {
  SavedMap map = random_map(1, 60, 12 + 3 * times);
  const SavedMap others = random_map(2, 60, 0);
  map.epoch = times;
  for (int i = 0; i < std::min(times, 30); ++i) {
    SavedTile& tile = map.tiles[static_cast<std::size_t>(2 * i)];
    tile.points = others.tiles[static_cast<std::size_t>(2 * i)].points;
    ++tile.utime;
  }
  return map;
}

/// Of the map that grew once more, what save_map() need not be given.
SavedMap news_of(int times) {
  SavedMap map = grown(times);
  const SavedMap before = grown(times - 1);
  for (std::size_t i = 0; i < map.tiles.size(); ++i) {
    if (map.tiles[i].utime != before.tiles[i].utime) continue;
    map.tiles[i].on_disk = true;
    map.tiles[i].points.clear();
  }
  const auto same = [](const scan::Keyframe& a, const scan::Keyframe& b) {
    return a.utime == b.utime && a.points == b.points && a.T_map_base.matrix() == b.T_map_base.matrix();
  };
  while (map.nodes_on_disk < before.nodes.size() &&
         same(map.nodes[map.nodes_on_disk], before.nodes[map.nodes_on_disk])) {
    map.nodes[map.nodes_on_disk++].points = {};
  }
  return map;
}

TEST(MapFolder, OnlyWhatIsNewIsWritten) {
  const auto scratch = test::TemporaryFolder::in_memory();
  save_map(grown(0), scratch / "town");
  const SavedMap news = news_of(1);
  EXPECT_GE(news.nodes_on_disk, 12U);
  const auto file_of = [&](const SavedTile& tile) { return (scratch / "town") / map_tile_file(tile.key); };
  std::vector<fs::file_time_type> written;
  for (const SavedTile& tile : news.tiles) written.push_back(fs::last_write_time(file_of(tile)));
  save_map(news, scratch / "town");
  EXPECT_TRUE(equal(load_map(scratch / "town"), grown(1)));
  for (std::size_t i = 0; i < news.tiles.size(); ++i)
    EXPECT_EQ(fs::last_write_time(file_of(news.tiles[i])) == written[i], news.tiles[i].on_disk) << i;
}

TEST(MapFolder, WhatIsSaidToBeThereAndIsNotIsAnErrorAndTheOldMapStays) {
  const auto scratch = test::TemporaryFolder::in_memory();
  EXPECT_THROW(save_map(news_of(1), scratch / "town"), MapFolderError);
  EXPECT_FALSE(fs::exists(scratch / "town"));
}

TEST(MapFolder, KilledAtAnyMomentWhileItGrowsTheLastWholeOneIsThere) {
  const auto scratch = test::TemporaryFolder::in_memory();
  const fs::path folder = scratch / "town";
  std::mt19937 random(5);
  int last = 0;
  save_map(grown(0), folder);
  for (unsigned round = 0; round < 25 || (last <= 5 && round < 1000); ++round) {
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      for (int times = last + 1;; ++times) save_map(news_of(times), folder);
    }
    usleep(static_cast<useconds_t>(1000 + random() % (40000 + 2000 * round)));  // a busy machine takes longer
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    const SavedMap found = load_map(folder);
    ASSERT_GE(found.epoch, last) << round;
    last = found.epoch;
    ASSERT_TRUE(equal(found, grown(last))) << round;
  }
  EXPECT_GT(last, 5);
}

}  // namespace
}  // namespace curbstone::mapper::storage
