#include "common/tile_sync/drive_follower.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace curbstone {
namespace {

constexpr std::int64_t kPageStart = 1'700'000'000'000'000;  // us; a page begins here
constexpr TileKey kPage{170'000'000, 0};

tile_index_t index_of(std::int32_t poses, std::int64_t now, std::int32_t epoch = 1) {
  tile_index_t index{};
  index.utime = now;
  index.owner = "mapper";
  index.channel = "MAP_TRAJECTORY";
  index.epoch = epoch;
  index.num_tiles = 1;
  index.tile_x = {kPage.x};
  index.tile_y = {kPage.y};
  index.version = {poses};
  return index;
}

class DriveFollowerTest : public testing::Test {
 protected:
  DriveFollowerTest() { follower_.start_epoch(1); }
  void receive(int from, int to) {
    for (int i = from; i < to; ++i) follower_.add(kPageStart + i * 50'000);
  }
  DriveFollower follower_{"listener"};
};

TEST_F(DriveFollowerTest, AsksForNothingWhileItHasAllPoses) {
  receive(0, 20);
  follower_.announced(index_of(20, kPageStart + 1'000'000));
  EXPECT_EQ(follower_.make_request(kPageStart + 5'000'000).num_tiles, 0);
  EXPECT_FALSE(follower_.fault());
}

TEST_F(DriveFollowerTest, AsksForThePageOfPosesThatItLacksAndSaysSoUntilItHasThem) {
  receive(0, 5);
  receive(15, 20);
  follower_.announced(index_of(20, kPageStart + 1'000'000));
  EXPECT_EQ(follower_.make_request(kPageStart + 1'100'000).num_tiles, 0) << "they may be on their way";
  EXPECT_FALSE(follower_.fault());
  const tile_request_t request = follower_.make_request(kPageStart + 1'400'000);
  ASSERT_EQ(request.num_tiles, 1);
  EXPECT_EQ(request.channel, "MAP_TRAJECTORY");
  EXPECT_EQ((TileKey{request.tile_x[0], request.tile_y[0]}), kPage);
  EXPECT_EQ(request.have[0], 10);
  EXPECT_TRUE(follower_.fault());
  receive(0, 20);
  EXPECT_FALSE(follower_.fault());
  EXPECT_EQ(follower_.make_request(kPageStart + 9'000'000).num_tiles, 0);
}

TEST_F(DriveFollowerTest, APoseThatComesAgainIsNoNews) {
  EXPECT_TRUE(follower_.add(kPageStart));
  EXPECT_FALSE(follower_.add(kPageStart));
}

TEST_F(DriveFollowerTest, AnotherEpochsIndexAndAnotherChannelsSayNothing) {
  follower_.announced(index_of(20, kPageStart, 2));
  tile_index_t tiles = index_of(20, kPageStart);
  tiles.channel = "MAP_POINTS";
  follower_.announced(tiles);
  EXPECT_FALSE(follower_.fault());
}

TEST_F(DriveFollowerTest, StampsOfAnyValueDoNoHarm) {
  for (const std::int64_t utime : {std::int64_t{1}, std::numeric_limits<std::int64_t>::max()})
    EXPECT_TRUE(follower_.add(utime));
  for (int i = 0; i < 2000; ++i) follower_.add(kPageStart + i);
  follower_.announced(index_of(static_cast<std::int32_t>(kMaxPosesPerPage), kPageStart));
  EXPECT_FALSE(follower_.fault()) << "no page has more";
}

}  // namespace
}  // namespace curbstone
