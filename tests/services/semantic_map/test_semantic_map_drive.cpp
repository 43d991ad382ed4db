#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <curbstone/map_trajectory_t.hpp>
#include <curbstone/tile_index_t.hpp>
#include <curbstone/tile_request_t.hpp>
#include <thread>
#include <utility>

#include "common/bus/local_bus.hpp"
#include "common/tile_sync/drive_pages.hpp"
#include "tests/services/semantic_map/semantic_map_node_test.hpp"
#include "tests/services/semantic_map/store/empty_journal.hpp"

namespace curbstone::semantic_map {
namespace {

/// A mapper that has said all poses of the drive, of which semantic_map heard some, and says pages again when asked.
class LostPoses : public SemanticMapNodeTest {
 protected:
  void SetUp() override {
    SemanticMapNodeTest::SetUp();
    bus_.subscribe<tile_request_t>("TILE_REQUEST", [this](const tile_request_t& m) { answer(m); });
  }
  void begin(store::UnusableFile unusable = store::UnusableFile::kThrows) {
    node_ = std::make_unique<SemanticMapNode>(config("map.db"), bus_, unusable);
    node_->connect(bus_);
  }
  void send(int from, int to) {
    for (int i = from; i < to; ++i) bus_.publish("MAP_POSE", pose_at(stamp(i), 0.15 * i));
    bus_.dispatch();
  }
  /// The mapper's index of `poses` poses, and the ticks of the second after it.
  void pass_second(int poses) {
    tile_index_t index{};
    index.utime = stamp(poses);
    index.owner = "mapper";
    index.channel = kDriveChannel;
    index.epoch = 1;
    std::map<TileKey, std::int32_t> versions;
    for (int i = 0; i < poses; ++i) ++versions[drive_page(stamp(i))];
    for (const auto& [key, version] : versions) {
      index.tile_x.push_back(key.x);
      index.tile_y.push_back(key.y);
      index.version.push_back(version);
    }
    index.num_tiles = static_cast<std::int32_t>(versions.size());
    said_ = poses;
    bus_.publish("TILE_INDEX", index);
    bus_.dispatch();
    for (int i = 0; i < 50; ++i) {
      node_->tick(stamp(poses) + i * 20'000);
      bus_.dispatch();
    }
  }
  void answer(const tile_request_t& request) {
    if (request.channel != kDriveChannel) return;
    for (std::size_t k = 0; k < request.tile_x.size(); ++k) {
      ++asked_;
      faults_ = node_->report().faults;
      map_trajectory_t page{};
      page.epoch = 1;
      page.page = kPageAgain;
      for (int i = 0; i < said_; ++i) {
        if (drive_page(stamp(i)).x != request.tile_x[k]) continue;
        page.utimes.push_back(stamp(i));
        page.revolutions.push_back(i);
        page.positions.push_back({static_cast<float>(0.15 * i), 0, 0});
        page.orientations.push_back({1, 0, 0, 0});
      }
      page.num_poses = static_cast<std::int32_t>(page.utimes.size());
      bus_.publish("MAP_TRAJECTORY", page);
    }
  }
  std::vector<tile::TrajectoryPose> stored() {
    node_->finish();
    return store::MapReader(config("map.db").map).trajectory();
  }
  static std::int64_t stamp(int i) { return kStart + i * 50'000; }

  LocalBus bus_;
  std::unique_ptr<SemanticMapNode> node_;
  std::vector<std::string> faults_;  // when they were asked for
  int said_ = 0;
  int asked_ = 0;
};

TEST_F(LostPoses, AProcessThatWasStoppedForSecondsAsksForThePosesOfThatTime) {
  begin();
  send(0, 100);
  send(200, 260);  // stopped for 5 s
  pass_second(260);
  ASSERT_EQ(faults_.size(), 1U) << "named while they are missing";
  EXPECT_NE(faults_[0].find("poses of the drive are missing"), std::string::npos) << faults_[0];
  EXPECT_TRUE(node_->report().faults.empty());
  EXPECT_EQ(node_->report().counters["poses_again"], 100);
  EXPECT_EQ(asked_, 1) << "they all lie in one page";
  const auto poses = stored();
  ASSERT_EQ(poses.size(), 260U);
  for (int i = 0; i < 260; ++i) {
    EXPECT_EQ(poses[static_cast<std::size_t>(i)].utime, stamp(i));
    EXPECT_NEAR(poses[static_cast<std::size_t>(i)].T_map_base.translation().x(), 0.15 * i, 1e-5);
  }
}

TEST_F(LostPoses, TheDriveGoesOnWhenTheHostsClockIsSetBack) {
  constexpr std::int64_t kHour = 3'600'000'000;
  for (const std::int64_t by : {kHour, std::int64_t{1'000'000}}) {
    begin();
    send(0, 100);
    for (int i = 100; i < 200; ++i) {
      map_pose_t pose = pose_at(stamp(i), 0.15 * i);
      pose.utime -= by;
      bus_.publish("MAP_POSE", pose);
    }
    bus_.dispatch();
    EXPECT_EQ(node_->report().counters["dropped.late"], 0) << by;
    const auto poses = stored();
    const auto last = std::max_element(poses.begin(), poses.end(),
                                       [](const auto& a, const auto& b) { return a.revolution < b.revolution; });
    EXPECT_EQ(last->revolution, 199) << by;
    EXPECT_EQ(last->utime, stamp(199) - by);
    if (by == kHour) {
      EXPECT_EQ(poses.size(), 200U);
    }
    node_.reset();
    bus_ = LocalBus();
    fs::remove(config("map.db").map);
  }
}

TEST_F(LostPoses, WhatIsDoneOnceInAWhileGoesOnWhenTheHostsClockIsSetBack) {
  constexpr std::int64_t kHour = 3'600'000'000;
  int indices = 0;
  bus_.subscribe<tile_index_t>("TILE_INDEX", [&](const tile_index_t& m) { indices += m.owner == "semantic_map"; });
  begin();
  send(0, 100);
  node_->tick(stamp(100));
  bus_.dispatch();
  const int before = std::exchange(indices, 0);
  for (int i = 100; i < 160; ++i) {
    map_pose_t pose = pose_at(stamp(i), 0.15 * i);
    pose.utime -= kHour;
    bus_.publish("MAP_POSE", pose);
    bus_.dispatch();
    node_->tick(stamp(i) - kHour);
    bus_.dispatch();
  }
  EXPECT_GE(before, 1);
  EXPECT_GE(indices, 2) << "in three seconds";
  const auto in_file = [&] { return store::MapReader(config("map.db").map).trajectory().size(); };
  for (int i = 160; i < 3000 && in_file() <= 100; ++i) {  // it is written beside, and as soon as the disk can
    node_->tick(stamp(i) - kHour);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_GT(in_file(), 100U) << "they are on disk, too";
}

TEST_F(LostPoses, APoseThatANewerOneOvertookIsLate) {
  begin();
  send(0, 100);
  send(98, 99);
  EXPECT_EQ(node_->report().counters["dropped.late"], 1);
}

TEST_F(LostPoses, ALidarThatCountsAnewAtAnEarlierTimeIsFollowed) {
  begin();
  send(0, 100);
  for (int i = 0; i < 100; ++i) {
    map_pose_t pose = pose_at(stamp(i), 15 + 0.15 * i);
    pose.utime -= 60'000'000;  // with its revolutions from 0 on
    bus_.publish("MAP_POSE", pose);
  }
  bus_.dispatch();
  EXPECT_EQ(node_->report().counters["dropped.late"], 0);
  EXPECT_EQ(stored().size(), 200U);
}

TEST_F(LostPoses, APoseThatIsOnlyAGuessIsNoneOfTheDrive) {
  begin();
  send(0, 100);
  for (int i = 100; i < 120; ++i) {
    map_pose_t guess = pose_at(stamp(i), 50);
    guess.flags = map_pose_t::LOST;
    bus_.publish("MAP_POSE", guess);
  }
  send(120, 140);
  const auto poses = stored();
  ASSERT_EQ(poses.size(), 120U);
  for (const auto& pose : poses) EXPECT_LT(pose.T_map_base.translation().x(), 0.15 * 140);
}

TEST_F(LostPoses, NothingIsAskedWhenNothingWasLost) {
  begin();
  send(0, 260);
  pass_second(260);
  EXPECT_TRUE(faults_.empty());
  EXPECT_EQ(asked_, 0);
  EXPECT_EQ(stored().size(), 260U);
}

TEST_F(LostPoses, TheSuccessorOfAKilledProcessGetsWhatWasSaidInBetweenAndGoesOnWithTheFile) {
  begin();
  send(0, 100);
  node_->tick(stamp(100));  // writes
  node_.reset();
  bus_ = LocalBus();
  bus_.subscribe<tile_request_t>("TILE_REQUEST", [this](const tile_request_t& m) { answer(m); });
  begin();
  send(120, 140);
  pass_second(140);
  EXPECT_EQ(stored().size(), 140U);
}

/// As by `cp other.db map.db`. What is in the file is lost, and all that was in it is stored in another.
TEST_F(LostPoses, AMapThatWasOverwrittenInMidDriveIsStoredOnceMore) {
  const std::string file = config("map.db").map;
  begin(store::UnusableFile::kWaits);
  send(0, 1);
  for (const tile::VotedTile& tile : street()) {
    for (const voted_points_t& page : to_pages(tile, 1, 1000)) bus_.publish("VOTED_POINTS", page);
  }
  int said = 100;
  const auto drive_until = [&](const char* counter, std::int64_t count) {
    for (int i = 0; i < 100 && node_->report().counters[counter] < count; ++i, said += 20) {
      send(said - 20, said);
      pass_second(said);
      std::this_thread::sleep_for(std::chrono::milliseconds(20));  // for the thread that writes
    }
  };
  send(1, said - 20);
  drive_until("store.transactions", 3);
  const std::size_t tiles = store::MapReader(file).tiles().size();
  ASSERT_GT(tiles, 0U);
  store::empty_journal(file);
  std::ofstream(file) << "a letter";
  drive_until("store.restored", 1);
  drive_until("poses_again", said - 60);
  EXPECT_EQ(stored().size(), static_cast<std::size_t>(said - 20));
  EXPECT_EQ(store::MapReader(file).tiles().size(), tiles);
  EXPECT_EQ(store::MapReader(file).integrity(), "ok");
}

TEST_F(LostPoses, APageThatComesBeforeTheDriveHasBegunClearsNoMap) {
  begin();
  send(0, 100);
  stored();
  node_.reset();
  bus_ = LocalBus();
  begin();
  map_trajectory_t page{};
  page.epoch = 1;
  page.page = kPageAgain;
  page.num_poses = 1;
  page.utimes = {stamp(3)};
  page.revolutions = {3};
  page.positions = {{0, 0, 0}};
  page.orientations = {{1, 0, 0, 0}};
  bus_.publish("MAP_TRAJECTORY", page);
  send(101, 102);
  EXPECT_EQ(stored().size(), 101U);
}

}  // namespace
}  // namespace curbstone::semantic_map
