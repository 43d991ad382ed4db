#include "services/tensor_voting/worker/voted_map.hpp"

#include <gtest/gtest.h>

#include "tests/services/tensor_voting/clouds.hpp"

namespace curbstone::tensor_voting::worker {
namespace {

using test_clouds::Tiles;

const std::vector<voting::VotingParameters> kScales = {{.sigma = 0.3, .radius = 0.9, .voxel = 0.1},
                                                       {.sigma = 0.1, .radius = 0.3, .voxel = 0.05}};

test_clouds::Tiles street() {
  return test_clouds::as_tiles(test_clouds::street(6000, 2));
}

map_points_t part(const test_clouds::Tiles& tiles, TileKey key, std::size_t first, std::size_t last) {
  map_points_t message{};
  message.tile_x = key.x;
  message.tile_y = key.y;
  message.first = static_cast<std::int32_t>(first);
  message.num_points = static_cast<std::int32_t>(last - first);
  for (std::size_t i = first; i < last; ++i) {
    const TilePoint& p = tiles.at(key)[i];
    message.x.push_back(p.x);
    message.y.push_back(p.y);
    message.z.push_back(p.z);
    message.intensity.push_back(p.intensity);
  }
  return message;
}

/// What everybody votes on, at once.
VotedMap complete(const test_clouds::Tiles& tiles) {
  VotedMap map({}, kScales);
  for (const auto& [key, points] : tiles) map.take(part(tiles, key, 0, points.size()), true);
  return map;
}

void expect_equal(const VotedMap& map, const VotedMap& expected) {
  for (const auto& [key, tile] : expected.points().tiles()) {
    EXPECT_TRUE(map.is_current(key));
    EXPECT_EQ(map.revision(key), expected.revision(key));
    for (std::size_t scale = 0; scale < kScales.size(); ++scale) {
      EXPECT_EQ(map.fields()[scale].sums(key), expected.fields()[scale].sums(key));
    }
  }
}

TEST(VotedMapTest, TilesTakenOverPieceByPieceComeToTheSame) {
  const test_clouds::Tiles tiles = street();
  VotedMap map({}, kScales);
  for (const auto& [key, points] : tiles) map.take(part(tiles, key, 0, points.size()), false);
  EXPECT_EQ(map.num_pairs(), 0) << "nothing of it matters";
  map.reassign([](TileKey) { return true; }, 0, 0);
  int steps = 0;
  while (map.is_moving()) map.move(500), ++steps;
  EXPECT_GT(steps, 5);
  EXPECT_LT(steps, 13);
  expect_equal(map, complete(tiles));
}

TEST(VotedMapTest, TheNearestTilesAreTakenOverFirst) {
  const test_clouds::Tiles tiles = street();
  VotedMap map({}, kScales);
  for (const auto& [key, points] : tiles) map.take(part(tiles, key, 0, points.size()), false);
  map.reassign([](TileKey) { return true; }, 1.5, 1.5);
  map.move(1500);
  EXPECT_TRUE(map.is_moving());
  EXPECT_TRUE(map.is_current({0, 0})) << "the vehicle's own, and those around it";
  EXPECT_FALSE(map.is_current({3, 0}));
}

TEST(VotedMapTest, PointsThatArriveMeanwhileAreVotedOnOnce) {
  const test_clouds::Tiles tiles = street();
  VotedMap map({}, kScales);
  for (const auto& [key, points] : tiles) map.take(part(tiles, key, 0, points.size() / 2), false);
  map.reassign([](TileKey) { return true; }, 0, 0);
  map.move(1000);
  for (const auto& [key, points] : tiles) map.take(part(tiles, key, points.size() / 2, points.size()), true);
  while (map.is_moving()) map.move(1000);
  expect_equal(map, complete(tiles));
}

TEST(VotedMapTest, TilesThatGoAndComeBackLeaveNoTrace) {
  const test_clouds::Tiles tiles = street();
  VotedMap map({}, kScales);
  for (const auto& [key, points] : tiles) map.take(part(tiles, key, 0, points.size() / 2), true);
  const auto left = [](TileKey key) { return key.x < 0; };
  map.reassign(left, 0, 0);
  map.move(300);  // some are taken out, others not yet
  EXPECT_TRUE(map.is_moving());
  for (const auto& [key, points] : tiles) {
    map.take(part(tiles, key, points.size() / 2, points.size()), left(key));
  }
  map.reassign([](TileKey) { return true; }, 0, 0);
  while (map.is_moving()) map.move(300);
  expect_equal(map, complete(tiles));
}

TEST(VotedMapTest, WhatMattersNoMoreIsTakenOut) {
  const test_clouds::Tiles tiles = street();
  VotedMap map = complete(tiles);
  map.reassign([](TileKey key) { return key.x < 0; }, 0, 0);
  while (map.is_moving()) map.move(1000);
  test_clouds::Tiles kept = tiles;
  std::erase_if(kept, [](const auto& tile) { return tile.first.x >= 0; });
  const VotedMap expected = complete(kept);
  for (const auto& [key, points] : kept) {
    EXPECT_EQ(map.fields()[0].sums(key), expected.fields()[0].sums(key)) << "no vote of theirs is left";
  }
  EXPECT_EQ(map.fields()[0].num_tiles(), kept.size());
  EXPECT_EQ(map.points().tiles().size(), tiles.size()) << "the points are kept, for another time";
}

TEST(VotedMapTest, ATileLetGoWhileItWaitsIsNoMatter) {
  const test_clouds::Tiles tiles = street();
  VotedMap map({}, kScales);
  for (const auto& [key, points] : tiles) map.take(part(tiles, key, 0, points.size()), false);
  map.reassign([](TileKey) { return true; }, 0, 0);
  for (const auto& [key, points] : tiles) map.erase(key);
  while (map.is_moving()) map.move(1000);
  EXPECT_EQ(map.fields()[0].num_tiles(), 0U);
  EXPECT_EQ(map.revision({0, 0}), 0);
}

/// Every third point of a tile is taken out again, by records that follow it.
test_clouds::Tiles with_removals(test_clouds::Tiles tiles, TileKey key) {
  std::vector<TilePoint>& records = tiles.at(key);
  const std::size_t count = records.size();
  for (std::size_t i = 0; i < count; i += 3) records.push_back(removal_of(records[i]));
  return tiles;
}

TEST(VotedMapTest, WhatIsTakenOutLeavesTheVotesOfTheRest) {
  const TileKey key{0, 0};
  const test_clouds::Tiles tiles = street();
  const test_clouds::Tiles records = with_removals(tiles, key);
  test_clouds::Tiles rest = tiles;
  std::vector<TilePoint>& kept = rest.at(key);
  for (std::size_t i = 0, at = 0; i < tiles.at(key).size(); ++i)
    i % 3 == 0 ? (void)kept.erase(kept.begin() + static_cast<std::ptrdiff_t>(at)) : (void)++at;

  VotedMap map = complete(tiles);
  std::map<TileKey, std::int32_t> before;
  for (const auto& [k, points] : tiles) before[k] = map.revision(k);
  (void)map.take_changed();
  const auto taken = map.take(part(records, key, tiles.at(key).size(), records.at(key).size()), true);
  EXPECT_EQ(taken.outcome, PointTiles::Outcome::kAdded);
  EXPECT_TRUE(taken.removed);
  const VotedMap expected = complete(rest);
  for (const auto& [k, points] : rest) {
    for (std::size_t scale = 0; scale < kScales.size(); ++scale)
      EXPECT_EQ(map.fields()[scale].sums(k), expected.fields()[scale].sums(k));
    EXPECT_EQ(map.points().find(k)->points.size(), points.size());
  }
  for (const TileKey& k : map.take_changed()) {
    if (!tiles.contains(k)) continue;
    EXPECT_GT(map.revision(k), before[k]) << "fewer votes, and yet a later revision";
  }
  expect_equal(map, complete(records));  // for whoever comes late and gets all of it at once
}

/// No surface has so many voters about a point: foliage may.
TEST(VotedMapTest, TheRevisionGrowsThoughAPointIsTakenOutOfAFilledSpace) {
  for (const voting::VotingParameters& scale : kScales) {
    const std::vector<voting::VotingParameters> scales = {scale};
    const int step = scales.back().voxel < 0.1 ? 25 : 50;  // in kPositionStep
    const int reach = scales.back().voxel < 0.1 ? 12 : 10;
    const auto at = [](int i) { return static_cast<std::int16_t>(750 + i); };
    test_clouds::Tiles tiles;
    std::vector<TilePoint>& points = tiles[{0, 0}];
    for (int x = -reach; x <= reach; ++x) {
      for (int y = -reach; y <= reach; ++y) {
        for (int z = -reach; z <= reach; ++z)
          points.push_back({at(x * step), at(y * step), static_cast<std::int16_t>(z * step), 1});
      }
    }
    const std::size_t count = points.size();
    const TilePoint middle = points[count / 2];
    ASSERT_EQ(middle.x, 750);
    points.push_back(removal_of(middle));
    VotedMap map({}, scales);
    (void)map.take(part(tiles, {0, 0}, 0, count), true);
    const std::int32_t before = map.revision({0, 0});
    std::int64_t votes = -1;
    for (const voting::VotingField& field : map.fields()) votes -= field.num_votes({0, 0});
    (void)map.take(part(tiles, {0, 0}, count, count + 1), true);
    for (const voting::VotingField& field : map.fields()) votes += field.num_votes({0, 0});
    EXPECT_LE(-votes, most_votes_lost_with_a_point(scales)) << "with so much the revision must make up for it";
    EXPECT_GT(-votes, most_votes_lost_with_a_point(scales) / 5) << "and with no more than needed";
    EXPECT_GT(map.revision({0, 0}), before);
  }
}

TEST(VotedMapTest, ATileThatWaitsForItsTurnLosesPointsToo) {
  const TileKey key{0, 0};
  const test_clouds::Tiles records = with_removals(street(), key);
  VotedMap map({}, kScales);
  for (const auto& [k, all] : records) map.take(part(records, k, 0, all.size() / 2), false);
  map.reassign([](TileKey) { return true; }, 0, 0);
  map.move(300);
  for (const auto& [k, all] : records) map.take(part(records, k, all.size() / 2, all.size()), true);
  while (map.is_moving()) map.move(300);
  expect_equal(map, complete(records));
}

TEST(VotedMapTest, WhatIsNotThereCannotBeTakenOut) {
  const TileKey key{0, 0};
  test_clouds::Tiles tiles = street();
  VotedMap map = complete(tiles);
  const std::size_t count = tiles.at(key).size();
  tiles.at(key).push_back(removal_of(tiles.at(key).front()));
  tiles.at(key).push_back(removal_of(tiles.at(key).front()));  // twice
  EXPECT_EQ(map.take(part(tiles, key, count, count + 2), true).outcome, PointTiles::Outcome::kRefused);
  expect_equal(map, complete(street()));
  EXPECT_EQ(map.take(part(tiles, key, count, count + 1), true).outcome, PointTiles::Outcome::kAdded);
}

}  // namespace
}  // namespace curbstone::tensor_voting::worker
