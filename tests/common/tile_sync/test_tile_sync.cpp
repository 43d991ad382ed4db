#include "common/tile_sync/tile_sync.hpp"

#include <gtest/gtest.h>

namespace curbstone {
namespace {

TEST(TileSync, EmptyCatalogStillSaysItLives) {
  TileCatalog catalog("mapper", "MAP_POINTS");
  const auto pages = catalog.make_index(1, 0, 0);
  ASSERT_EQ(pages.size(), 1U);
  EXPECT_EQ(pages[0].num_tiles, 0);
  EXPECT_EQ(pages[0].owner, "mapper");
}

TEST(TileSync, ChangedTilesComeFirstThenNearOnes) {
  TileCatalog catalog("m", "C");
  for (int x = 0; x < 5; ++x) catalog.set_version({x, 0}, 1);
  (void)catalog.make_index(1, 0, 0);
  catalog.set_version({4, 0}, 2);
  const auto page = catalog.make_index(2, 0, 0).at(0);
  EXPECT_EQ(page.tile_x, (std::vector<std::int32_t>{4, 0, 1, 2, 3}));
}

TEST(TileSync, EveryTileOfALargeMapIsAnnouncedInTurn) {
  TileCatalog catalog("m", "C");
  for (int x = 0; x < 10000; ++x) catalog.set_version({x, 0}, 1);
  std::unordered_set<TileKey, TileKeyHash> seen;
  for (int round = 0; round < 20; ++round) {
    for (const auto& page : catalog.make_index(round, 0, 0)) {
      EXPECT_LE(page.getEncodedSize(), 48 * 1024);
      for (std::size_t i = 0; i < page.tile_x.size(); ++i) seen.insert({page.tile_x[i], page.tile_y[i]});
    }
  }
  EXPECT_EQ(seen.size(), 10000U);
}

TEST(TileSync, FollowerCatchesUpAfterAnyLoss) {
  TileCatalog catalog("m", "C");
  TileFollower follower("f", "C");
  catalog.set_version({1, 2}, 10);
  catalog.set_version({3, 4}, 5);
  follower.set_have({3, 4}, 5);
  for (const auto& page : catalog.make_index(1'000'000, 0, 0)) EXPECT_TRUE(follower.announced(page));
  EXPECT_EQ(follower.behind(), 1U);
  EXPECT_EQ(follower.make_request(1'100'000).num_tiles, 0) << "patience: it may be on its way";
  const auto request = follower.make_request(2'000'000);
  ASSERT_EQ(request.num_tiles, 1);
  EXPECT_EQ(follower.make_request(2'500'000).num_tiles, 0) << "asked a moment ago";
  catalog.request(request);
  catalog.request(request);
  const auto wanted = catalog.take_requests(10);
  ASSERT_EQ(wanted.size(), 1U);
  EXPECT_EQ(wanted[0].key, (TileKey{1, 2}));
  EXPECT_EQ(wanted[0].have, 0);
  follower.set_have({1, 2}, 10);
  EXPECT_EQ(follower.behind(), 0U);
}

TEST(TileSync, AnotherEpochIsNotAnswered) {
  TileCatalog catalog("m", "C");
  TileFollower follower("f", "C");
  catalog.start_epoch(2);
  catalog.set_version({0, 0}, 1);
  const auto page = catalog.make_index(0, 0, 0).at(0);
  EXPECT_FALSE(follower.announced(page));
  follower.start_epoch(2);
  EXPECT_TRUE(follower.announced(page));
}

TEST(TileSync, APromisedTileIsExpectedAndAskedForOnceSomeOfItIsThere) {
  TileCatalog catalog("mapper", "MAP_POINTS");
  TileFollower follower("voter", "MAP_POINTS");
  catalog.start_epoch(1);
  follower.start_epoch(1);
  const auto announce = [&](std::int64_t now) {
    for (const auto& page : catalog.make_index(now, 0, 0)) EXPECT_TRUE(follower.announced(page));
  };
  catalog.promise({2, 3});
  announce(1'000'000);
  EXPECT_TRUE(follower.is_behind({2, 3}));
  EXPECT_EQ(follower.make_request(9'000'000).num_tiles, 0);
  catalog.set_version({2, 3}, 5);
  catalog.promise({2, 3});
  announce(9'000'000);
  EXPECT_EQ(follower.make_request(9'100'000).num_tiles, 0) << "it is probably on its way";
  EXPECT_EQ(follower.make_request(9'300'000).num_tiles, 1);
  catalog.request(follower.make_request(11'000'000));
  EXPECT_EQ(catalog.num_requested(), 1U);
  EXPECT_EQ(catalog.take_requests(9).size(), 1U);
  follower.set_have({2, 3}, 5);
  EXPECT_EQ(follower.behind(), 0U);
}

/// A request of the tiles (0, 0), (1, 0), ... by a listener that has the version `have` of each.
tile_request_t request_of(std::int32_t tiles, std::int32_t have) {
  tile_request_t request{};
  request.channel = "C";
  request.epoch = 1;
  request.num_tiles = tiles;
  for (std::int32_t x = 0; x < tiles; ++x) {
    request.tile_x.push_back(x);
    request.tile_y.push_back(0);
    request.have.push_back(have);
  }
  return request;
}

TEST(TileCatalog, SendsWhatTheRequesterLacksThatHasLeast) {
  TileCatalog catalog("m", "C");
  catalog.start_epoch(1);
  catalog.set_version({0, 0}, 9);
  for (const std::int32_t have : {7, 3, 5}) catalog.request(request_of(1, have));
  const auto wanted = catalog.take_requests(9);
  ASSERT_EQ(wanted.size(), 1U);
  EXPECT_EQ(wanted[0].have, 3);
}

TEST(TileCatalog, SendsNothingThatTheRequesterHasOrThatIsRemovedMeanwhile) {
  TileCatalog catalog("m", "C");
  catalog.start_epoch(1);
  catalog.set_version({0, 0}, 9);
  catalog.request(request_of(1, 9));
  EXPECT_TRUE(catalog.take_requests(9).empty());
  catalog.request(request_of(1, 8));
  catalog.remove({0, 0});
  EXPECT_TRUE(catalog.take_requests(9).empty());
  EXPECT_EQ(catalog.num_requested(), 0U);
}

TEST(TileCatalog, KeepsABoundedNumberOfRequests) {
  constexpr auto kMost = static_cast<std::int32_t>(TileCatalog::kMaxWaiting);
  TileCatalog catalog("m", "C");
  catalog.start_epoch(1);
  for (std::int32_t x = 0; x < kMost + 5; ++x) catalog.set_version({x, 0}, 1);
  catalog.request(request_of(kMost + 5, 0));
  EXPECT_EQ(catalog.num_requested(), TileCatalog::kMaxWaiting);
  EXPECT_EQ(catalog.take_requests(TileCatalog::kMaxWaiting + 5).size(), TileCatalog::kMaxWaiting);
  catalog.request(request_of(kMost + 5, 0));
  EXPECT_EQ(catalog.num_requested(), TileCatalog::kMaxWaiting) << "there is room again";
}

TEST(TileFollower, AsksAtOnceForWhatItCannotGoOnFrom) {
  TileFollower follower("map", "VOTED_POINTS");
  follower.start_epoch(1);
  follower.set_have({2, 3}, 10);
  follower.lacks({2, 3}, 12);
  const auto request = follower.make_request(5'000'000);
  ASSERT_EQ(request.num_tiles, 1);
  EXPECT_EQ(request.have[0], 10);
  EXPECT_EQ(follower.make_request(5'100'000).num_tiles, 0) << "and not again within a second";
  follower.set_have({2, 3}, 12);
  EXPECT_EQ(follower.behind(), 0U);
}

TEST(TileFollower, DoesNotWaitForATileThatWasJustAnnouncedAndCannotBeGoneOnFrom) {
  TileCatalog catalog("mapper", "MAP_POINTS");
  catalog.start_epoch(1);
  catalog.set_version({2, 3}, 12);
  TileFollower follower("voter", "MAP_POINTS");
  follower.start_epoch(1);
  for (const auto& page : catalog.make_index(5'000'000, 0, 0)) EXPECT_TRUE(follower.announced(page));
  EXPECT_EQ(follower.make_request(5'100'000).num_tiles, 0) << "it is probably on its way";
  follower.lacks({2, 3}, 12);
  EXPECT_EQ(follower.make_request(5'100'000).num_tiles, 1);
}

TEST(TileFollower, AsksWhenTheClockIsSetBackToo) {
  TileCatalog catalog("mapper", "MAP_POINTS");
  catalog.start_epoch(1);
  catalog.set_version({2, 3}, 5);
  TileFollower follower("voter", "MAP_POINTS");
  follower.start_epoch(1);
  constexpr std::int64_t kHour = 3'600'000'000;
  for (const auto& page : catalog.make_index(2 * kHour, 0, 0)) EXPECT_TRUE(follower.announced(page));
  EXPECT_EQ(follower.make_request(2 * kHour - 1000, 9, 300'000, 0, 0).num_tiles, 0)
      << "another host's clock, 1 ms ahead";
  EXPECT_EQ(follower.make_request(kHour, 9, 300'000, 0, 0).num_tiles, 1);
  EXPECT_EQ(follower.make_request(kHour + 500'000, 9, 300'000, 0, 0).num_tiles, 0);
  EXPECT_EQ(follower.make_request(1, 9, 300'000, 0, 0).num_tiles, 1) << "again, though it was asked for in the future";
}

TEST(TileFollower, AsksForTheNearestTilesFirst) {
  TileCatalog catalog("mapper", "MAP_POINTS");
  catalog.start_epoch(1);
  for (std::int32_t x = 0; x < 10; ++x) catalog.set_version({x, 0}, 5);
  TileFollower follower("voter", "MAP_POINTS");
  follower.start_epoch(1);
  for (const auto& page : catalog.make_index(1'000'000, 0, 0)) EXPECT_TRUE(follower.announced(page));
  EXPECT_TRUE(follower.is_behind_near(21, 1.5, 3, 1'000'000));
  EXPECT_FALSE(follower.is_behind_near(21, 1.5, 3, 999'999)) << "it was announced later";
  EXPECT_FALSE(follower.is_behind_near(21, 30, 3, 1'000'000));
  const auto request = follower.make_request(2'000'000, 3, 0, 22.5, 1.5);
  EXPECT_EQ(request.tile_x, (std::vector<std::int32_t>{7, 6, 8}));
  for (std::int32_t x = 0; x < 10; ++x) follower.set_have({x, 0}, 5);
  EXPECT_FALSE(follower.is_behind_near(21, 1.5, 100, 1'000'000));
}

}  // namespace
}  // namespace curbstone
