#include "services/mapper/storage/map_saver.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>

#include "services/mapper/storage/map_folder.hpp"
#include "tests/damaged_spill_files.hpp"
#include "tests/services/mapper/dense_map/ground_patch.hpp"
#include "tests/services/mapper/storage/saved_map_fixture.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::mapper::storage {
namespace {

using dense_map::kPeriod;
using dense_map::kStart;
using dense_map::patch;
using ::testing::HasSubstr;

/// A map whose far tiles and keyframes all lie in a file, and its folder.
class AFarMapIsSaved : public ::testing::Test {
 protected:
  AFarMapIsSaved() {
    config::DenseConfig config;
    config.awake = 0;
    config.asleep_here = 0;
    dense_ = std::make_unique<dense_map::DenseMap>(config, spill_file_);
  }
  /// Along x, a keyframe each metre.
  void drive(int from, int to) {
    for (int x = from; x < to; ++x) {
      const Pose T_map_base(Eigen::Translation3d(x, 0, 0));
      for (int i = 0; i < 3; ++i) {
        const auto points = patch(0.5, 0, 0.01);
        dense_->set_anchor(atlas_.visit(utime_ += kPeriod, T_map_base, points));
        (void)dense_->insert(points, T_map_base, utime_);
      }
    }
    spill_file_->flush();
  }
  /// A place that was left long ago gets something new, and is left again.
  void come_back_to(double x) {
    for (int i = 0; i < 3; ++i)
      (void)dense_->insert(patch(1.5, 1.5, 0.01), Pose(Eigen::Translation3d(x, 0, 0)), utime_ += kPeriod);
    for (int i = 0; i < 70; ++i)
      (void)dense_->insert(patch(0.5, 0, 0.01), Pose(Eigen::Translation3d(2000, 0, 0)), utime_ += kPeriod);
    spill_file_->flush();
  }
  [[nodiscard]] MapSnapshot snapshot(const MapVersions& on_disk = {}) const {
    return take_snapshot(*dense_, atlas_, 0.05, 7, on_disk);
  }
  void save() {
    saver_.begin(snapshot(saver_.on_disk()));
    saver_.finish();
  }
  /// All that the folder should hold.
  [[nodiscard]] SavedMap all() const {
    SavedMap map = snapshot().map;
    for (SavedTile& tile : map.tiles) {
      if (!tile.spilled.empty()) tile.points = std::exchange(tile.spilled, {}).read().points();
    }
    return map;
  }

  test::TemporaryFolder folder_;
  std::shared_ptr<SpillFile> spill_file_ = std::make_shared<SpillFile>(folder_.path().string(), 0);
  std::unique_ptr<dense_map::DenseMap> dense_;
  pose_graph::Atlas atlas_{config::AtlasConfig{}, spill_file_};
  MapSaver saver_{folder_ / "map"};
  std::int64_t utime_ = kStart;
};

TEST_F(AFarMapIsSaved, BitForBit) {
  drive(0, 300);
  ASSERT_TRUE(dense_->tile({10, 0})->is_in_file());
  save();
  EXPECT_EQ(saver_.fault(), "");
  EXPECT_TRUE(equal(load_map(folder_ / "map"), all()));
  drive(300, 400);
  save();
  EXPECT_TRUE(equal(load_map(folder_ / "map"), all()));
  EXPECT_EQ(saver_.counters()["folder.left_out"], 0);
}

TEST_F(AFarMapIsSaved, WithoutWhatTheDiskDoesNotGiveBackWhichFollowsOnceItDoes) {
  drive(0, 300);
  save();
  const SavedMap before = all();
  drive(300, 500);
  come_back_to(0);
  ASSERT_TRUE(dense_->tile({0, 0})->is_in_file());
  const SavedMap after = all();
  test::flip_a_bit_of_each_spilled_page();
  save();
  EXPECT_THAT(saver_.fault(), HasSubstr("does not give them back"));
  EXPECT_GT(saver_.counters()["folder.left_out"], 50);
  EXPECT_EQ(saver_.counters()["folder.saved"], 2);
  EXPECT_EQ(saver_.counters()["faults.folder"], 0);

  const SavedMap found = load_map(folder_ / "map");
  const auto tile_of = [](const SavedMap& map, TileKey key) {
    return std::find_if(map.tiles.begin(), map.tiles.end(), [&](const SavedTile& tile) { return tile.key == key; });
  };
  const auto kept = tile_of(found, {0, 0});
  ASSERT_NE(kept, found.tiles.end());
  EXPECT_EQ(kept->points, tile_of(before, {0, 0})->points) << "as it was";
  EXPECT_EQ(kept->utime, tile_of(before, {0, 0})->utime);
  EXPECT_GT(tile_of(after, {0, 0})->points.size(), kept->points.size());
  EXPECT_EQ(tile_of(found, {120, 0}), found.tiles.end()) << "it was never saved";
  for (const SavedTile& tile : found.tiles) {
    if (tile.key.x < 1) continue;
    EXPECT_EQ(tile.points, tile_of(after, tile.key)->points) << "no wrong number";
  }
  ASSERT_EQ(found.nodes.size(), after.nodes.size()) << "they keep their place";
  EXPECT_EQ(found.nodes[100].points.size(), before.nodes[100].points.size());
  EXPECT_TRUE(found.nodes[400].points.empty());
  EXPECT_EQ(found.edges.size(), after.edges.size());

  test::flip_a_bit_of_each_spilled_page();  // as they were
  save();
  EXPECT_EQ(saver_.fault(), "");
  EXPECT_TRUE(equal(load_map(folder_ / "map"), after));
}

TEST_F(AFarMapIsSaved, InANewEpochKeepsNothingOfTheOneBefore) {
  drive(0, 300);
  save();
  test::flip_a_bit_of_each_spilled_page();
  MapSnapshot moved = take_snapshot(*dense_, atlas_, 0.05, 8, saver_.on_disk());
  const auto is_spilled = [](const SavedTile& tile) { return !tile.spilled.empty(); };
  const auto lost = std::count_if(moved.map.tiles.begin(), moved.map.tiles.end(), is_spilled);
  const auto all_tiles = static_cast<std::ptrdiff_t>(moved.map.tiles.size());
  saver_.begin(std::move(moved));
  saver_.finish();
  EXPECT_EQ(static_cast<std::ptrdiff_t>(load_map(folder_ / "map").tiles.size()), all_tiles - lost);
}

}  // namespace
}  // namespace curbstone::mapper::storage
