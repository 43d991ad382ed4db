#include "services/semantic_map/pipeline/tile_pipeline.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <memory>
#include <set>
#include <vector>

#include "services/semantic_map/pipeline/update_schedule.hpp"
#include "tests/damaged_spill_files.hpp"
#include "tests/services/semantic_map/synthetic_ground.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::semantic_map::pipeline {
namespace {

WorkResult update(TilePipeline& pipeline, TileKey key) {
  return pipeline.run({TileWork::Kind::kUpdate, key});
}

void update_columns(TilePipeline& pipeline, TileKey key) {
  pipeline.run({TileWork::Kind::kUpdateColumns, key});
}

void settle_oldest(TilePipeline& pipeline) {
  pipeline.run({TileWork::Kind::kOldestStep});
}

class PipelineOfAStreet : public testing::Test {
 protected:
  static const std::vector<tile::VotedTile>& tiles() {
    static const std::vector<tile::VotedTile> voted = [] {
      SyntheticCloud cloud;
      cloud.ground(-9, -9, 9, 9, 150, [](double x, double y) { return 0.02 * x + (y > 1 ? 0.1 : 0.0); });
      detect::cloud_map::CloudMap counts;
      detect::cloud_map::CloudMapOptions options;
      options.threads = 1;
      return detect::cloud_map::vote_tiles(cloud.points, options, counts);
    }();
    return voted;
  }
  /// What the tiles say when all of them are there at once.
  static const TilePipeline& at_once() {
    static const TilePipeline pipeline = [] {
      TilePipeline p({}, {});
      for (const tile::VotedTile& tile : tiles()) p.set_voted(tile);
      p.settle();
      return p;
    }();
    return pipeline;
  }
  static const tile::VotedTile& tile_at(TileKey key) {
    return *std::find_if(tiles().begin(), tiles().end(), [&](const tile::VotedTile& t) { return t.key == key; });
  }
  static tile::VotedTile thinner(tile::VotedTile tile) {
    tile.points.shorten(tile.points.size() / 2);
    return tile;
  }
  static void expect_as_at_once(const TilePipeline& pipeline) {
    for (const tile::VotedTile& tile : tiles()) {
      EXPECT_EQ(*pipeline.classes(tile.key), *at_once().classes(tile.key)) << tile.key.x << ' ' << tile.key.y;
      EXPECT_EQ(*pipeline.curbs(tile.key), *at_once().curbs(tile.key)) << tile.key.x << ' ' << tile.key.y;
    }
    EXPECT_EQ(pipeline.num_stale(), 0U);
  }
};

TEST_F(PipelineOfAStreet, TilesThatMeetABoxAreFoundInOrderHoweverLargeTheBox) {
  const std::vector<TileKey> keys = at_once().keys();
  ASSERT_GT(keys.size(), 20U);
  for (const double half : {0.0, 0.5, 1.5, 3.0, 4.0, 100.0, 1e300}) {
    for (const double x : {-7.0, -3.0, 0.0, 0.3, 50.0}) {
      const Eigen::Vector2d min(x - half, -half);
      const Eigen::Vector2d max(x + half, half);
      std::vector<TileKey> expected;
      std::copy_if(keys.begin(), keys.end(), std::back_inserter(expected), [&](TileKey key) {
        const Eigen::Array2d corner(key.x * kTileSize, key.y * kTileSize);
        return (corner + kTileSize >= min.array()).all() && (corner <= max.array()).all();
      });
      EXPECT_EQ(at_once().keys_in(min, max), expected) << half << " about " << x;
    }
  }
}

TEST_F(PipelineOfAStreet, DoesNotDependOnTheOrderOfTilesNorOnWhoLooksWhen) {
  TilePipeline backward({}, {});
  for (auto it = tiles().rbegin(); it != tiles().rend(); ++it) {
    backward.set_voted(thinner(*it));
    update(backward, it->key);
    for (int i = 0; i < 7; ++i) settle_oldest(backward);
    backward.set_voted(*it);
    if (it->key.x % 2 == 0) update(backward, it->key);
  }
  while (backward.num_stale() > 0) settle_oldest(backward);
  expect_as_at_once(backward);
}

TEST_F(PipelineOfAStreet, SettlesTheSameOnAnyNumberOfThreads) {
  for (const int threads : {1, 2, 5}) {
    TilePipeline pipeline({}, {});
    std::set<TileKey> all;
    for (const tile::VotedTile& tile : tiles()) {
      pipeline.set_voted(tile);
      all.insert(tile.key);
    }
    EXPECT_EQ(pipeline.settle(threads).changed, all);
    EXPECT_EQ(pipeline.num_evidence(), at_once().num_evidence());
    expect_as_at_once(pipeline);
  }
}

TEST_F(PipelineOfAStreet, ComesBackFromEveryOtherRevisionOfATile) {
  TilePipeline pipeline = at_once();
  for (std::size_t i = 0; i < tiles().size(); i += 5) {
    pipeline.set_voted(thinner(tiles()[i]));
    pipeline.settle();
    pipeline.set_voted(tiles()[i]);
  }
  pipeline.settle();
  expect_as_at_once(pipeline);
}

/// While others grow beside it, so that the ground about it becomes another in between.
TEST_F(PipelineOfAStreet, WhatGrowsBitByBitComesOutAsWhatCameAtOnce) {
  TilePipeline pipeline({}, {});
  for (const unsigned parts : {7U, 3U, 2U, 1U}) {
    for (tile::VotedTile tile : tiles()) {
      tile.points.shorten(tile.points.size() / parts);
      pipeline.set_voted(tile, parts != 7U);
      update_columns(pipeline, tile.key);
      if (tile.key.x % 3 == 0) update(pipeline, tile.key);
    }
  }
  pipeline.settle();
  expect_as_at_once(pipeline);
}

TEST_F(PipelineOfAStreet, ShowsWhatIsNewOnTheGroundOfBeforeAndTheRestWhenItsTurnComes) {
  TilePipeline pipeline = at_once();
  tile::VotedTile tile = tiles()[tiles().size() / 2];
  update_columns(pipeline, tile.key);
  const tile::VotedTile lower = tile_at({tile.key.x + 1, tile.key.y});
  tile::VotedTile beside = lower;
  beside.points = {};
  for (tile::VotedPoint p : lower.points) {
    p.z += 0.15F;
    beside.points.push_back(p);
  }
  pipeline.set_voted(beside);
  update(pipeline, beside.key);  // the ground between the two rises
  tile::VotedPoint low;          // just high enough to be in the way, on the ground of before
  low.x = 2.82F;
  low.y = 1.5F;
  const double x = tile.key.x * kTileSize + 2.82, y = tile.key.y * kTileSize + 1.5;
  low.z = static_cast<float>(0.02 * x + (y > 1 ? 0.1 : 0.0) + 0.24);
  for (int i = 0; i < 3; ++i) tile.points.push_back(low);
  pipeline.set_voted(tile, true);
  constexpr std::size_t kCell = 12 * kCellsPerTile + 23;
  update_columns(pipeline, tile.key);
  EXPECT_EQ(pipeline.classes(tile.key)->cell_class[kCell], tile::CellClass::kObstacle);
  pipeline.settle();
  EXPECT_NE(pipeline.classes(tile.key)->cell_class[kCell], tile::CellClass::kObstacle);
  TilePipeline again = at_once();
  again.set_voted(beside);
  again.set_voted(tile);
  again.settle();
  EXPECT_EQ(*pipeline.classes(tile.key), *again.classes(tile.key));
}

TEST_F(PipelineOfAStreet, DoesNothingMoreForATileThatCameOutAsItWas) {
  TilePipeline pipeline = at_once();
  const tile::VotedTile& tile = tiles()[tiles().size() / 2];
  pipeline.set_voted(tile);
  const std::int64_t before = pipeline.num_evidence();
  EXPECT_TRUE(pipeline.settle().changed.empty());
  EXPECT_LE(pipeline.num_evidence() - before, 9) << "its neighbours look at its points, and nobody looks at theirs";
}

TEST_F(PipelineOfAStreet, UpdatesOneTileAtThePriceOfOne) {
  TilePipeline pipeline({}, {});
  for (const tile::VotedTile& tile : tiles()) pipeline.set_voted(tile);
  const tile::VotedTile& tile = tiles()[tiles().size() / 2];
  const WorkResult result = update(pipeline, tile.key);
  EXPECT_EQ(result.changed, std::set<TileKey>{tile.key});
  EXPECT_TRUE(result.cost > 0.45 && result.cost < 5) << "a tile's evidence and little besides: " << result.cost;
  EXPECT_EQ(pipeline.classes(tile.key)->utime, tile.utime);
  EXPECT_EQ(pipeline.num_evidence(), 1);
}

/// What the node does at each tick. A step is stale for a second before it is due, and makes the next one stale.
TEST_F(PipelineOfAStreet, SettlesInTimeByTheSchedule) {
  TilePipeline pipeline({}, {});
  UpdateSchedule schedule(1000);
  std::int64_t now = 1'700'000'000'000'000;
  for (const tile::VotedTile& tile : tiles()) {
    pipeline.set_voted(tile);
    schedule.voted({.key = tile.key, .points = tile.points.size()}, now);
  }
  for (int tick = 0; tick < 500; ++tick, now += 20'000) {
    while (const auto work = schedule.next_work({0, 0}, pipeline.backlog(), now))
      schedule.spent(pipeline.run(*work).cost);
  }
  EXPECT_EQ(schedule.num_waiting(), 0U);
  expect_as_at_once(pipeline);
}

/// A step of one page that adds so many points.
tile::VotedStep step_of(std::int32_t base, std::int32_t first, std::int32_t points) {
  voted_points_t page{};
  page.base = base;
  page.revision = base + 1;
  page.chain = 7;
  page.utime = 1000 + base;
  page.num_pages = 1;
  page.num_scales = 1;
  page.sigma = {0.3F};
  page.first = first;
  page.num_points = points;
  page.total = first + points;
  for (std::int32_t i = 0; i < points; ++i) {
    page.x.push_back(static_cast<std::int16_t>(100 + i));
    page.y.push_back(200);
    page.z.push_back(0);
    page.intensity.push_back(0);
    page.voter.push_back(first + i);
  }
  return {.key = {0, 0}, .chain = 7, .base = base, .revision = base + 1, .pages = {page}};
}

/// Steps of a tile far from the others, until these have fallen asleep.
void drive_on(TilePipeline& pipeline, std::int64_t now) {
  tile::VotedStep elsewhere = step_of(0, 0, 1);
  elsewhere.key = {1000, 1000};
  pipeline.set_time(now);
  for (std::size_t i = 0; i <= pipeline.num_tiles(); ++i) (void)pipeline.apply(elsewhere);
}

TEST_F(PipelineOfAStreet, WhatSleptComesOutAsWhatDidNot) {
  TilePipeline pipeline({}, {});
  for (tile::VotedTile tile : tiles()) {
    tile.points.shorten(tile.points.size() / 2);
    pipeline.set_voted(tile);
    if (tile.key.x % 3 == 0) update(pipeline, tile.key);
  }
  drive_on(pipeline, TilePipeline::kAwake);
  EXPECT_EQ(pipeline.num_asleep(), tiles().size());
  for (const tile::VotedTile& tile : tiles()) {
    if (tile.key.y % 2 == 0) pipeline.set_voted(tile, true);
    if (tile.key.x % 2 == 0) update_columns(pipeline, tile.key);
  }
  drive_on(pipeline, 2 * TilePipeline::kAwake);
  for (const tile::VotedTile& tile : tiles()) pipeline.set_voted(tile, true);
  pipeline.settle();
  expect_as_at_once(pipeline);
}

TEST_F(PipelineOfAStreet, WhatWokeToBeSettledSleepsAgain) {
  TilePipeline pipeline({}, {});
  for (const tile::VotedTile& tile : tiles()) pipeline.set_voted(tile);
  drive_on(pipeline, TilePipeline::kAwake);
  pipeline.settle();
  EXPECT_EQ(pipeline.num_asleep(), tiles().size());
  expect_as_at_once(pipeline);
}

TEST_F(PipelineOfAStreet, WhatAnOldStepWokeSleepsSoonerAlsoIfTheVehicleStands) {
  TilePipeline pipeline({}, {});
  for (const tile::VotedTile& tile : tiles()) pipeline.set_voted(tile);
  drive_on(pipeline, TilePipeline::kAwake);
  settle_oldest(pipeline);
  EXPECT_LT(pipeline.num_asleep(), tiles().size());
  const std::int64_t later = TilePipeline::kAwake + TilePipeline::kAwakeForOldStep;
  for (std::size_t i = 0; i < tiles().size(); ++i) pipeline.set_time(later);
  EXPECT_EQ(pipeline.num_asleep(), tiles().size());
}

TEST_F(PipelineOfAStreet, WhatSleptInAFileComesOutAsWhatDidNot) {
  const test::TemporaryFolder folder;
  const auto file = std::make_shared<SpillFile>(folder.path().string(), 0);
  TilePipeline pipeline({}, {}, {}, file);
  for (tile::VotedTile tile : tiles()) {
    tile.points.shorten(tile.points.size() / 2);
    pipeline.set_voted(tile);
    if (tile.key.x % 3 == 0) update(pipeline, tile.key);
  }
  drive_on(pipeline, TilePipeline::kAwake);
  file->flush();
  EXPECT_EQ(file->bytes_in_memory(), 0U);
  EXPECT_GT(file->bytes_in_file(), 1000 * tiles().size());
  for (const tile::VotedTile& tile : tiles()) pipeline.set_voted(tile, true);
  pipeline.settle();
  expect_as_at_once(pipeline);
  EXPECT_TRUE(pipeline.take_lost().empty());
}

TEST_F(PipelineOfAStreet, WhatTheFileCannotBringBackIsReportedAndMayComeAgain) {
  const test::TemporaryFolder folder;
  const auto file = std::make_shared<SpillFile>(folder.path().string(), 0);
  TilePipeline pipeline({}, {}, {}, file);
  for (const tile::VotedTile& tile : tiles()) pipeline.set_voted(tile);
  drive_on(pipeline, TilePipeline::kAwake);
  file->flush();
  test::truncate_spill_files();
  pipeline.settle();
  EXPECT_EQ(pipeline.take_lost().size(), tiles().size());
  for (const tile::VotedTile& tile : tiles()) pipeline.set_voted(tile);
  pipeline.settle();
  expect_as_at_once(pipeline);
}

TEST(TilePipeline, TellsWhatAStepMadeOfItsTile) {
  TilePipeline pipeline({}, {});
  const auto begun = pipeline.apply(step_of(0, 0, 10));
  ASSERT_TRUE(begun);
  EXPECT_EQ(begun->points_before, 0U);
  EXPECT_EQ(begun->points, 10U);
  const auto grown = pipeline.apply(step_of(1, 10, 5));
  ASSERT_TRUE(grown);
  EXPECT_EQ(grown->key, (TileKey{0, 0}));
  EXPECT_EQ(grown->revision, 2);
  EXPECT_EQ(grown->utime, 1001);
  EXPECT_EQ(grown->points_before, 10U);
  EXPECT_EQ(grown->points, 15U);
}

TEST(TilePipeline, AStepThatDoesNotGoOnFromItsTileChangesNothing) {
  TilePipeline pipeline({}, {});
  EXPECT_FALSE(pipeline.apply(step_of(3, 10, 5)));
  EXPECT_EQ(pipeline.num_tiles(), 0U);
  ASSERT_TRUE(pipeline.apply(step_of(0, 0, 10)));
  pipeline.settle();
  EXPECT_FALSE(pipeline.apply(step_of(3, 10, 5)));
  EXPECT_EQ(pipeline.num_stale(), 0U);
}

TEST(TilePipeline, HasNoJumpsAtTilesOffTheEndOfInt32) {
  TilePipeline pipeline({}, {});
  tile::VotedTile tile;
  tile.key = {2147483647, -2147483647 - 1};
  for (int i = 0; i < 10; ++i) tile.points.push_back({});
  pipeline.set_voted(tile);
  EXPECT_EQ(update(pipeline, tile.key).changed.size(), 1U);
  pipeline.settle();
  EXPECT_EQ(pipeline.num_stale(), 0U);
}

}  // namespace
}  // namespace curbstone::semantic_map::pipeline
