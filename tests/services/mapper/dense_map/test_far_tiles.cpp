#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "common/packing/spill_file.hpp"
#include "services/mapper/dense_map/dense_map.hpp"
#include "services/mapper/dense_map/tile_records.hpp"
#include "tests/damaged_spill_files.hpp"
#include "tests/services/mapper/dense_map/ground_patch.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::mapper::dense_map {
namespace {

using test::kSecond;

/// 60 x 60 points of two anchors, of which some have been taken out since.
DenseTile tile_with_removals() {
  DenseTile tile(-3, 25);
  for (int i = 0; i < 3600; ++i) {
    tile.append({static_cast<std::int16_t>(i % 60 * 25), static_cast<std::int16_t>(i / 60 * 25),
                 static_cast<std::int16_t>(i % 7 - 1000), static_cast<std::uint8_t>(i)},
                kStart + (i < 2000 ? 0 : 5 * kSecond), i < 2000 ? 0 : 1);
  }
  tile.remove({3, 1999, 2500}, kStart + 9 * kSecond);
  return tile;
}

/// A street to the east of 2 m, one scan each metre and all of it another anchor's; the vehicle has gone on.
DenseMap drive(int metres, std::shared_ptr<SpillFile> far, const config::DenseConfig& config = {}) {
  DenseMap map(config, std::move(far));
  std::int64_t t = kStart;
  for (int x = 0; x < metres; ++x) {
    map.set_anchor(x);
    for (int i = 0; i < 3; ++i)
      (void)map.insert(patch(0.5, 0, 0.01), Pose(Eigen::Translation3d(x, 0, 0)), t += kPeriod);
  }
  return map;
}

using Content = std::vector<std::pair<TileKey, TileRecords>>;
Content content_of(const DenseMap& map) {
  Content all;
  for (const TileKey& key : map.keys()) all.emplace_back(key, *map.tile(key)->read());
  return all;
}
int num_away(const DenseMap& map) {
  int spilled = 0;
  for (const TileKey& key : map.keys()) spilled += map.tile(key)->is_spilled() ? 1 : 0;
  return spilled;
}

class FarTiles : public testing::Test {
 protected:
  test::TemporaryFolder folder_;
  std::shared_ptr<SpillFile> file_ = std::make_shared<SpillFile>(folder_.path().string(), 0);
};

TEST_F(FarTiles, RecordsComeBackWithEveryBit) {
  constexpr auto kLow16 = std::numeric_limits<std::int16_t>::min(), kHigh16 = std::numeric_limits<std::int16_t>::max();
  constexpr auto kLow64 = std::numeric_limits<std::int64_t>::min(), kHigh64 = std::numeric_limits<std::int64_t>::max();
  const TileRecords records{{{0, 1499, kLow16, 0}, {-1, 0, kHigh16, 255}, {kLow16, kHigh16, 0, 1}},
                            {{-1, 0, kHigh64}, {2'000'000'000, 1, kLow64}, {-1, 2, 0}}};
  const PackedRecords packed(records, *file_);
  EXPECT_EQ(packed.read(), records);
  file_->flush();
  EXPECT_EQ(packed.read(), records);
  EXPECT_EQ(PackedRecords(TileRecords{}, *file_).read(), TileRecords{});
  EXPECT_TRUE(PackedRecords().empty());
  EXPECT_EQ(PackedRecords().read(), TileRecords{});
}

TEST_F(FarTiles, ATileThatWasAwayIsTheSame) {
  DenseTile tile = tile_with_removals();
  DenseTile other = tile;
  EXPECT_FALSE(tile.spill(*file_)) << "it is awake";
  tile.sleep();
  other.sleep();
  const TileRecords before = *tile.read();
  ASSERT_TRUE(tile.spill(*file_));
  EXPECT_FALSE(tile.spill(*file_)) << "it is away";
  file_->flush();
  EXPECT_TRUE(tile.is_spilled());
  EXPECT_EQ(tile.bytes(), 0U);
  EXPECT_EQ(*tile.read(), before);
  EXPECT_EQ(tile.read()->standing(), before.standing());
  EXPECT_EQ(tile.read()->points(), before.points());
  EXPECT_EQ(tile.num_records(), before.records.size());
  EXPECT_EQ(tile.num_points(), before.points().size());
  ASSERT_TRUE(tile.wake());
  ASSERT_TRUE(other.wake());
  EXPECT_EQ(*tile.read(), before);
  for (const TilePoint& p : before.points()) EXPECT_TRUE(tile.was_occupied(tile.voxel_number(p)));
  for (DenseTile* const t : {&tile, &other}) t->append({3, 3, 3, 3}, kStart + 20 * kSecond, 2);
  EXPECT_EQ(*tile.read(), *other.read());
  EXPECT_EQ(tile.utime(), other.utime());
}

TEST_F(FarTiles, WhatGotNothingNewIsNotWrittenAnew) {
  DenseTile tile = tile_with_removals();
  tile.sleep();
  ASSERT_TRUE(tile.spill(*file_));
  file_->flush();
  const std::size_t once = file_->bytes_in_file();
  ASSERT_TRUE(tile.wake());
  tile.sleep();
  ASSERT_TRUE(tile.spill(*file_));
  EXPECT_EQ(file_->bytes_in_memory(), 0U) << "nothing waits to be written";
  EXPECT_EQ(file_->bytes_in_file(), once);
  ASSERT_TRUE(tile.wake());
  tile.append({3, 3, 3, 3}, kStart + 20 * kSecond, 2);
  const TileRecords grown = *tile.read();
  tile.sleep();
  ASSERT_TRUE(tile.spill(*file_));
  file_->flush();
  EXPECT_EQ(*tile.read(), grown);
  SpillFile other;
  const PackedRecords alone(grown, other);
  EXPECT_EQ(file_->bytes_in_file(), other.bytes_in_memory()) << "what was written first is gone";
}

TEST_F(FarTiles, ARollBackReadsOnlyWhatItCuts) {
  for (const std::int64_t until : {20, 7, 2, -1}) {
    DenseTile tile = tile_with_removals(), other = tile;
    tile.sleep();
    other.sleep();
    ASSERT_TRUE(tile.spill(*file_));
    ASSERT_TRUE(tile.truncate_after(kStart + until * kSecond));
    ASSERT_TRUE(other.truncate_after(kStart + until * kSecond));
    EXPECT_EQ(tile.is_spilled(), until == 20);
    EXPECT_EQ(*tile.read(), *other.read());
    EXPECT_EQ(tile.utime(), other.utime());
    EXPECT_EQ(tile.num_points(), other.num_points());
    tile.append({3, 3, 3, 3}, kStart + 30 * kSecond, 2);
    ASSERT_EQ(tile.asleep(), other.asleep());
  }
}

TEST_F(FarTiles, ATileOfWhichABitIsWrongIsNotReturned) {
  DenseTile tile = tile_with_removals();
  tile.sleep();
  const TileRecords before = *tile.read();
  ASSERT_TRUE(tile.spill(*file_));
  file_->flush();
  test::flip_a_bit_of_each_spilled_page();
  EXPECT_EQ(tile.read(), nullptr);
  EXPECT_FALSE(tile.wake());
  test::flip_a_bit_of_each_spilled_page();
  EXPECT_FALSE(tile.wake()) << "not read for each point that comes";
  tile.allow_retry();
  ASSERT_TRUE(tile.wake());
  EXPECT_EQ(*tile.read(), before);
}

TEST_F(FarTiles, ATileThatTheDiskDoesNotReturnSaysSo) {
  DenseTile tile = tile_with_removals();
  tile.sleep();
  ASSERT_TRUE(tile.spill(*file_));
  file_->flush();
  test::truncate_spill_files();
  EXPECT_EQ(tile.read(), nullptr);
  EXPECT_FALSE(tile.truncate_after(kStart));
  EXPECT_FALSE(tile.wake());
  EXPECT_TRUE(tile.is_spilled());
  EXPECT_THROW((void)tile.packed().read(), std::runtime_error);
  EXPECT_EQ(file_->failed_reads(), 4);
}

TEST_F(FarTiles, ALongDriveTakesNoMoreMemoryThanAShortOne) {
  const DenseMap one = drive(1600, file_), two = drive(3200, file_);
  ASSERT_GT(two.size(), one.size() * 19 / 10);
  const std::size_t a_tile = (two.bytes() - one.bytes()) / (two.keys().size() - one.keys().size());
  EXPECT_LT(a_tile, sizeof(DenseTile) + 20) << "nothing of it but where it lies";
  EXPECT_GT(num_away(two), 1600) << "of some 2000";
}

TEST_F(FarTiles, TheMapIsTheSameWithAFileWithoutAndWithOneThatFails) {
  const DenseMap with = drive(700, file_);
  const DenseMap without = drive(700, std::make_shared<SpillFile>());
  const auto nowhere = std::make_shared<SpillFile>("/nowhere/at/all");
  const DenseMap failing = drive(700, nowhere);
  EXPECT_GT(num_away(with), 100);
  EXPECT_EQ(content_of(with), content_of(without));
  EXPECT_EQ(content_of(with), content_of(failing));
  EXPECT_NE(nowhere->fault(), "");
  EXPECT_GT(nowhere->bytes_in_memory(), 0U);
}

TEST_F(FarTiles, AreNeverTooManyForTheDiskButForTheMemory) {
  config::DenseConfig config;
  config.max_points = 150'000;
  DenseMap with = drive(700, file_, config);
  EXPECT_GT(with.size(), 250'000);
  EXPECT_EQ(with.counters()["dense.evicted_tiles"], 0);
  EXPECT_EQ(content_of(with), content_of(drive(700, file_)));
  EXPECT_TRUE(with.take_evicted().empty());
  for (const char* const nowhere : {"", "/nowhere/at/all"}) {
    DenseMap without = drive(700, std::make_shared<SpillFile>(nowhere), config);
    EXPECT_GT(without.counters()["dense.evicted_tiles"], 100) << nowhere;
    EXPECT_LT(without.size(), 170'000);
    EXPECT_EQ(static_cast<std::int64_t>(without.take_evicted().size()), without.counters()["dense.evicted_tiles"]);
  }
}

/// What lies in the file is not given up for what must stay in memory.
TEST_F(FarTiles, ThatTheDiskHasStayWhenItTakesNoMore) {
  const test::TemporaryFolder folder;
  const std::string disk = folder.path().string();
  if (unshare(CLONE_NEWNS) != 0 || mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
      mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=200k") != 0)
    GTEST_SKIP() << "no right to mount a small disk";
  {
    config::DenseConfig config;
    config.max_points = 150'000;
    const auto small = std::make_shared<SpillFile>(disk, 0);
    const DenseMap map = drive(3000, small, config);
    EXPECT_NE(small->fault(), "");
    EXPECT_GT(map.counters()["dense.evicted_tiles"], 100);
    ASSERT_NE(map.tile({0, 0}), nullptr);
    EXPECT_TRUE(map.tile({0, 0})->is_in_file());
    EXPECT_TRUE(map.tile({0, 0})->read());
    std::int64_t here = map.size();
    for (const TileKey& key : map.keys()) {
      const DenseTile& tile = *map.tile(key);
      if (tile.is_in_file()) here -= static_cast<std::int64_t>(tile.num_records());
    }
    EXPECT_LT(here, 170'000);
  }
  umount2(disk.c_str(), MNT_DETACH);
}

/// Listeners have its records: others in their place would contradict them.
TEST_F(FarTiles, AnEvictedOneIsNotBegunAgainUntilTheMapHasMoved) {
  config::DenseConfig config;
  config.max_points = 100'000;
  DenseMap map = drive(700, std::make_shared<SpillFile>(), config);
  ASSERT_TRUE(map.evicted().contains({0, 0}));
  std::int64_t late = kStart + 5000 * kPeriod;
  const auto look = [&](int scans) {
    for (int i = 0; i < scans; ++i) (void)map.insert(patch(0.5, 0, 0.01), Pose::Identity(), late += kPeriod);
  };
  look(5);
  EXPECT_EQ(map.tile({0, 0}), nullptr);
  map.move({});
  (void)map.finish();
  EXPECT_TRUE(map.evicted().empty());
  look(5);
  ASSERT_NE(map.tile({0, 0}), nullptr);
  EXPECT_GT(map.tile({0, 0})->num_points(), 50U);
}

TEST_F(FarTiles, MoveAsIfTheyWereInMemory) {
  DenseMap map = drive(1200, file_);
  const Content before = content_of(map);
  const std::int64_t size = map.size();
  std::vector<Pose> corrections;
  for (int i = 0; i < 1200; ++i) corrections.push_back(Pose(Eigen::Translation3d(0, 0, 2)));
  map.move(corrections);
  (void)map.finish();
  EXPECT_EQ(map.size(), size);
  EXPECT_GT(num_away(map), 300);
  const Content after = content_of(map);
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_EQ(after[i].first, before[i].first);
    TileRecords expected = before[i].second;
    for (TilePoint& p : expected.records) p.z = static_cast<std::int16_t>(p.z + 1000);
    EXPECT_EQ(after[i].second.records, expected.records);
    EXPECT_EQ(after[i].second.runs, expected.runs);
  }
}

TEST_F(FarTiles, RollBackGivesTheMapOfThatTime) {
  const Content short_drive = content_of(drive(900, file_));
  DenseMap map = drive(1200, file_);
  const std::int64_t until = kStart + 900 * 3 * kPeriod;
  map.roll_back(until);
  Content cut = content_of(map);
  std::erase_if(cut, [](const auto& tile) { return tile.second.records.empty(); });
  ASSERT_EQ(cut.size(), short_drive.size());
  for (std::size_t i = 0; i + 2 < cut.size(); ++i) EXPECT_EQ(cut[i], short_drive[i]) << i;
}

/// Listeners have its records: others in their place would contradict them.
TEST_F(FarTiles, WhatTheDiskDoesNotReturnStaysAsItIsAndIsMappedAnewOnceTheMapHasMoved) {
  DenseMap map = drive(1200, file_);
  file_->flush();
  test::truncate_spill_files();
  ASSERT_TRUE(map.tile({0, 0})->is_spilled());
  const std::int64_t size = map.size();
  const std::size_t records = map.tile({0, 0})->num_records();
  std::int64_t late = kStart + 5000 * kPeriod;
  const auto look = [&](int scans) {
    for (int i = 0; i < scans; ++i) (void)map.insert(patch(0.5, 0, 0.01), Pose::Identity(), late += kPeriod);
  };
  look(3);
  EXPECT_GT(file_->failed_reads(), 0);
  EXPECT_LT(file_->failed_reads(), 20) << "not once a point";
  EXPECT_TRUE(map.tile({0, 0})->is_spilled());
  EXPECT_EQ(map.tile({0, 0})->num_records(), records);
  EXPECT_EQ(map.size(), size);
  EXPECT_TRUE(map.take_evicted().empty());
  map.move({});
  (void)map.finish();
  EXPECT_EQ(map.tile({0, 0}), nullptr);
  EXPECT_LT(map.size(), size / 2);
  look(3);
  ASSERT_NE(map.tile({0, 0}), nullptr);
  EXPECT_EQ(map.tile({0, 0})->num_points() + map.tile({0, -1})->num_points(), 400U);
}

TEST_F(FarTiles, WhatTheDiskReturnsAfterAllGrowsAgain) {
  DenseMap map = drive(1200, file_);
  file_->flush();
  std::int64_t late = kStart + 5000 * kPeriod;
  const auto look = [&](int scans) {
    for (int i = 0; i < scans; ++i) (void)map.insert(patch(0.5, 0.8, 0.01), Pose::Identity(), late += kPeriod);
  };
  const std::size_t before = map.tile({0, 0})->num_records();
  test::flip_a_bit_of_each_spilled_page();
  look(3);
  EXPECT_EQ(map.tile({0, 0})->num_records(), before);
  test::flip_a_bit_of_each_spilled_page();
  look(64);
  EXPECT_GT(map.tile({0, 0})->num_records(), before);
  EXPECT_FALSE(map.tile({0, 0})->is_spilled());
}

}  // namespace
}  // namespace curbstone::mapper::dense_map
