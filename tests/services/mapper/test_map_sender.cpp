#include "services/mapper/map_sender.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <curbstone/map_points_t.hpp>
#include <curbstone/map_trajectory_t.hpp>
#include <curbstone/tile_index_t.hpp>

#include "common/bus/local_bus.hpp"
#include "tests/damaged_spill_files.hpp"
#include "tests/stamps.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::mapper {
namespace {

using test::kStart;

/// A dense map with so many points in one tile, a layer of 60 x 60 after the other.
void fill(dense_map::DenseMap& map, TileKey key, int count) {
  std::vector<TilePoint> points;
  for (int i = 0; i < count; ++i) {
    points.push_back({static_cast<std::int16_t>(i % 60 * 25), static_cast<std::int16_t>(i / 60 % 60 * 25),
                      static_cast<std::int16_t>(i / 3600 * 25), 1});
  }
  map.load(key, 0, kStart, points);
}

class MapSenderTest : public testing::Test {
 protected:
  MapSenderTest() {
    bus.subscribe<map_points_t>("MAP_POINTS", [this](const map_points_t& m) { sent.push_back(m); });
    bus.subscribe<map_trajectory_t>("MAP_TRAJECTORY", [this](const map_trajectory_t& m) { pages.push_back(m); });
    bus.subscribe<tile_index_t>("TILE_INDEX", [this](const tile_index_t& m) { index = m; });
  }
  void start_epoch(std::int32_t epoch, const std::vector<TrajectoryPoint>& drive = {}) {
    sender.start_epoch(epoch, {1, 1, 0}, drive);
    sender.queue_tiles(map.keys());
  }
  /// What goes out at once.
  std::vector<map_points_t> sent_at_once() { return sent_after(20'000); }
  /// What goes out so many us after the last time.
  std::vector<map_points_t> sent_after(std::int64_t us) {
    sent.clear();
    sender.send_changes(map, now += us);
    bus.dispatch();
    return sent;
  }
  static TileKey key_of(const map_points_t& m) { return {m.tile_x, m.tile_y}; }

  dense_map::DenseMap map{config::DenseConfig{}};
  LocalBus bus;
  MapSender sender{bus};
  std::int64_t now = kStart;
  std::vector<map_points_t> sent;
  std::vector<map_trajectory_t> pages;
  tile_index_t index{};
};

TEST_F(MapSenderTest, SendsOfATileWhatHasNotGoneOutYet) {
  fill(map, {0, 0}, 100);
  sender.queue_tiles({{0, 0}});
  ASSERT_EQ(sent_at_once().size(), 1U);
  EXPECT_EQ(sent[0].first, 0);
  EXPECT_EQ(sent[0].num_points, 100);
  EXPECT_TRUE(sent_at_once().empty());
  map = dense_map::DenseMap(config::DenseConfig{});
  fill(map, {0, 0}, 130);
  sender.queue_tiles({{0, 0}, {0, 0}});
  ASSERT_EQ(sent_at_once().size(), 1U);
  EXPECT_EQ(sent[0].first, 100);
  EXPECT_EQ(sent[0].num_points, 30);
}

TEST_F(MapSenderTest, ALargeTileGoesOutInPartsAndLetsOthersInBetween) {
  fill(map, {0, 0}, 10'000);
  fill(map, {1, 0}, 10);
  sender.queue_tiles({{0, 0}, {1, 0}});
  std::vector<int> first;
  for (int turn = 0; turn < 4; ++turn) {
    int points = 0;
    for (const map_points_t& m : sent_at_once()) {
      points += m.num_points;
      EXPECT_LE(m.num_points, 3000) << "fits into a message";
      if (key_of(m) == TileKey{0, 0}) first.push_back(m.first);
    }
    EXPECT_LE(points, 5000 + 3000) << "the bus has others to serve";
    if (turn == 0) {
      EXPECT_TRUE(std::any_of(sent.begin(), sent.end(), [](const auto& m) { return key_of(m) == TileKey{1, 0}; }));
    }
  }
  EXPECT_EQ(first, (std::vector{0, 3000, 6000, 9000}));
}

TEST_F(MapSenderTest, AFarTileGoesOutWholeBeforeTheNext) {
  for (int x = 20; x < 24; ++x) fill(map, {x, 0}, 8000);
  start_epoch(1);
  std::vector<int> order;
  for (int turn = 0; turn < 20; ++turn) {
    for (const map_points_t& m : sent_at_once()) order.push_back(m.tile_x);
  }
  EXPECT_EQ(order.size(), 12U);
  EXPECT_TRUE(std::is_sorted(order.begin(), order.end())) << "listeners keep one at a time";
}

TEST_F(MapSenderTest, AnnouncesWhatIsStillToGoOut) {
  fill(map, {0, 0}, 10);
  fill(map, {50, 0}, 100);
  start_epoch(1);
  EXPECT_EQ(sender.num_outstanding(), 2U);
  sender.send_index(now, {1, 1, 0});
  bus.dispatch();
  EXPECT_EQ(index.tile_x, (std::vector<std::int32_t>{0, 50}));
  EXPECT_EQ(index.version, (std::vector<std::int32_t>{0, 0}));
  (void)sent_at_once();
  sender.send_index(now, {1, 1, 0});
  bus.dispatch();
  EXPECT_EQ(index.version, (std::vector<std::int32_t>{10, 100}));
  EXPECT_EQ(sender.num_outstanding(), 0U);
}

/// What the disk does not return is tried again, ever less often.
TEST_F(MapSenderTest, SendsLaterWhatCouldNotBeRead) {
  const test::TemporaryFolder folder;
  config::DenseConfig config;
  config.asleep_here = 0;
  const auto far = std::make_shared<SpillFile>(folder.path().string(), 0);
  map = dense_map::DenseMap(config, far);
  fill(map, {0, 0}, 100);
  far->flush();
  test::flip_a_bit_of_each_spilled_page();
  sender.queue_tiles({{0, 0}});
  EXPECT_TRUE(sent_at_once().empty());
  EXPECT_EQ(far->unreadable(), 1);
  for (int i = 0; i < 500; ++i) EXPECT_TRUE(sent_at_once().empty());
  EXPECT_EQ(far->failed_reads(), 4) << "at once, after 1, 2 and 4 s";
  test::flip_a_bit_of_each_spilled_page();
  for (int i = 0; i < 400 && sent.empty(); ++i) (void)sent_at_once();
  ASSERT_EQ(sent.size(), 1U);
  EXPECT_EQ(sent[0].num_points, 100);
  EXPECT_EQ(far->unreadable(), 0);
  EXPECT_EQ(far->read_fault(), "");
  for (int i = 0; i < 400; ++i) EXPECT_TRUE(sent_at_once().empty());
}

/// A replay looks each quarter of a second: what has been mapped must not wait longer and longer.
TEST_F(MapSenderTest, SendsMoreAfterALongerTimeButNoFlood) {
  const auto points_after = [&](std::int64_t us) {
    map = dense_map::DenseMap(config::DenseConfig{});
    for (int x = 0; x < 100; ++x) fill(map, {x, 0}, 1000);
    start_epoch(1);
    int points = 0;
    for (const map_points_t& m : sent_after(us)) points += m.num_points;
    return points;
  };
  (void)points_after(20'000);
  EXPECT_EQ(points_after(0), 5000) << "after a revolution";
  EXPECT_EQ(points_after(20'000), 5000);
  EXPECT_EQ(points_after(250'000), 60'000);
  EXPECT_EQ(points_after(3'000'000), 65'000);
  EXPECT_EQ(points_after(-1'000'000), 5000) << "a clock that was set back";
}

TEST_F(MapSenderTest, ANewEpochSendsAllOfTheMapNearestFirstAndTheDriveInPages) {
  for (const int x : {4, -2, 0}) fill(map, {x, 0}, 5);
  std::vector<TrajectoryPoint> drive;
  for (int i = 0; i < 1000; ++i) drive.push_back({kStart + i, i, Pose::Identity()});
  start_epoch(7, drive);
  std::vector<TileKey> order;
  for (const map_points_t& m : sent_at_once()) {
    EXPECT_EQ(m.epoch, 7);
    order.push_back(key_of(m));
  }
  EXPECT_EQ(order, (std::vector<TileKey>{{0, 0}, {-2, 0}, {4, 0}}));
  for (int i = 0; i < 3; ++i) sender.send_trajectory();
  bus.dispatch();
  ASSERT_EQ(pages.size(), 2U);
  EXPECT_EQ(pages[0].num_pages, 2);
  EXPECT_EQ(pages[0].num_poses + pages[1].num_poses, 1000);
  EXPECT_EQ(pages[1].revolutions.back(), 999);
}

TEST_F(MapSenderTest, WhatIsSeenForTheFirstTimeDoesNotWaitBehindAMapThatGoesOutAnew) {
  for (int x = 20; x < 200; ++x) fill(map, {x, 0}, 1000);
  start_epoch(1);
  (void)sent_at_once();
  fill(map, {2, 0}, 10);
  sender.queue_tiles({{2, 0}});
  const auto now_sent = sent_at_once();
  ASSERT_FALSE(now_sent.empty());
  EXPECT_EQ(key_of(now_sent.front()), (TileKey{2, 0}));
  EXPECT_EQ(now_sent.size(), 6U) << "the rest goes out behind it";
}

TEST_F(MapSenderTest, WhatTheVehicleComesNearToGoesBeforeTheRest) {
  (void)sent_at_once();
  for (int x = 20; x < 200; ++x) fill(map, {x, 0}, 1000);
  start_epoch(1);
  sender.send_index(now, {540, 0, 0});
  std::vector<TileKey> order;
  for (const map_points_t& m : sent_at_once()) order.push_back(key_of(m));
  ASSERT_EQ(order.size(), 5U);
  for (const TileKey& key : order) EXPECT_NEAR(3 * key.x, 540, 45);
  std::size_t all = order.size();
  for (int turn = 0; turn < 40; ++turn) all += sent_at_once().size();
  EXPECT_EQ(all, 180U) << "each goes out once";
}

TEST_F(MapSenderTest, AnswersARequestFromWhatTheAskerHasAndNoMoreThanHasGoneOut) {
  fill(map, {2, 3}, 4000);
  sender.queue_tiles({{2, 3}});
  EXPECT_EQ(sent_at_once().front().num_points, 3000);
  tile_request_t request{};
  request.channel = "MAP_POINTS";
  request.num_tiles = 1;
  request.tile_x = {2};
  request.tile_y = {3};
  request.have = {1000};
  sender.request(request);
  sent.clear();
  sender.send_requested(map);
  bus.dispatch();
  ASSERT_FALSE(sent.empty());
  EXPECT_EQ(sent.front().first, 1000);
  EXPECT_EQ(sent.back().first + sent.back().num_points, 4000);
}

TEST_F(MapSenderTest, WhatTheMapHasGivenUpIsNotAnnouncedAnyMore) {
  fill(map, {0, 0}, 5);
  fill(map, {1, 0}, 5);
  sender.queue_tiles({{0, 0}, {1, 0}, {9, 9}});  // the last was given up while it waited
  EXPECT_EQ(sent_at_once().size(), 2U);
  sender.forget({{0, 0}});
  sender.send_index(kStart, Eigen::Vector3d::Zero());
  bus.dispatch();
  ASSERT_EQ(index.num_tiles, 1);
  EXPECT_EQ(index.tile_x[0], 1);
}

TEST_F(MapSenderTest, AtTheEndAllThatWaitsGoesOut) {
  fill(map, {0, 0}, 20'000);
  sender.queue_tiles({{0, 0}});
  sender.finish(map);
  bus.dispatch();
  EXPECT_EQ(sent.back().first + sent.back().num_points, 20'000);
  EXPECT_TRUE(sent_at_once().empty());
}

TEST_F(MapSenderTest, AnnouncesTheDriveAndSaysAPageOfItAgain) {
  tile_index_t of_drive{};
  bus.subscribe<tile_index_t>("TILE_INDEX", [&](const tile_index_t& m) {
    if (m.channel == "MAP_TRAJECTORY") of_drive = m;
  });
  start_epoch(7);
  for (int i = 0; i < 10; ++i) sender.add_pose({kStart + i * 50'000, i, Pose::Identity()});
  sender.send_index(kStart, {0, 0, 0});
  bus.dispatch();
  ASSERT_EQ(of_drive.num_tiles, 1);
  EXPECT_EQ(of_drive.version[0], 10);
  EXPECT_EQ(index.channel, "MAP_POINTS") << "that of the map too";

  tile_request_t request{};
  request.channel = "MAP_TRAJECTORY";
  request.epoch = 7;
  request.num_tiles = 1;
  request.tile_x = of_drive.tile_x;
  request.tile_y = of_drive.tile_y;
  request.have = {4};
  sender.request(request);
  for (int i = 0; i < 3; ++i) sender.send_requested(map);
  bus.dispatch();
  ASSERT_EQ(pages.size(), 1U);
  EXPECT_EQ(pages[0].num_poses, 10);
  EXPECT_EQ(pages[0].page, -1);
}

}  // namespace
}  // namespace curbstone::mapper
