#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "tests/services/tensor_voting/worker/tensor_voting_world.hpp"

namespace curbstone::tensor_voting::worker {
namespace {

/// Four tiles in a row, of which each has points: the first two vote for each other, the others do not reach them.
class FarTiles : public testing::Test {
 protected:
  static constexpr std::int64_t kStart = 1'000'000 * kSecond;

  /// A worker alone on its bus, with the vehicle at `x`, m.
  void start(double x) {
    revisions_.clear();
    bus_ = LocalBus();
    node_ = std::make_unique<TensorVotingNode>(TensorVotingConfig{}, "tensor_voting:2", bus_);
    node_->connect(bus_);
    bus_.subscribe<voted_points_t>("VOTED_POINTS", [this](const voted_points_t& m) {
      if (m.tile_x == 1) revisions_.push_back(m.revision);
    });
    map_pose_t pose{};
    pose.epoch = 1;
    pose.map_base_position[0] = x;
    bus_.publish("MAP_POSE", pose);
    for (int i = 0; i < 5; ++i) tick(1);
  }
  void publish_index(const std::string& owner, const std::string& channel, const std::vector<int>& tiles,
                     std::int32_t version) {
    tile_index_t index{};
    index.utime = now_;
    index.owner = owner;
    index.channel = channel;
    index.epoch = 1;
    index.num_pages = 1;
    for (const int x : tiles) {
      index.tile_x.push_back(x);
      index.tile_y.push_back(0);
      index.version.push_back(version);
    }
    index.num_tiles = static_cast<std::int32_t>(tiles.size());
    bus_.publish("TILE_INDEX", index);
  }
  /// As the mapper sends a tile: announced, then whole.
  void send(int tile) {
    publish_index("mapper", "MAP_POINTS", {tile}, kPoints);
    map_points_t message{};
    message.utime = now_;
    message.epoch = 1;
    message.tile_x = tile;
    message.num_points = kPoints;
    for (int i = 0; i < kPoints; ++i) {
      const int from_border = 5 * (i % 10) + 1;  // steps of 2 mm
      message.x.push_back(static_cast<std::int16_t>(tile == 1 ? from_border : kStepsPerTile - 1 - from_border));
      message.y.push_back(static_cast<std::int16_t>(700 + 5 * (i / 10)));
      message.z.push_back(10);
      message.intensity.push_back(0);
    }
    bus_.publish("MAP_POINTS", message);
  }
  void tick(double seconds) {
    now_ += static_cast<std::int64_t>(seconds * 1e6);
    bus_.dispatch();
    node_->tick(now_);
    bus_.dispatch();
  }

  static constexpr int kPoints = 40;
  LocalBus bus_;
  std::unique_ptr<TensorVotingNode> node_;
  std::int64_t now_ = kStart;
  std::vector<std::int32_t> revisions_;  // of the second tile, as published
};

TEST_F(FarTiles, ATileWhoseTurnHasComeKeepsTheVotesOfItsNeighboursUntilItIsPublished) {
  start(0);
  for (int tile = 0; tile < 4; ++tile) send(tile);
  tick(2);
  ASSERT_EQ(revisions_.size(), 1U) << "with all tiles near";
  const std::int32_t whole = revisions_.front();
  ASSERT_GT(whole, kPoints) << "it has votes";

  start(1000);
  publish_index("tensor_voting:1", "VOTED_POINTS", {1, 2}, 1);  // of a worker that is heard no more
  for (int i = 0; i < 5; ++i) tick(1);
  send(0);
  send(1);  // its neighbour, the third, was published by another worker and is not here: it has to wait
  for (int i = 0; i < 2; ++i) tick(2);
  EXPECT_TRUE(revisions_.empty());
  send(3);
  send(2);
  for (int i = 0; i < 6; ++i) tick(2);
  EXPECT_EQ(revisions_, std::vector{whole});
}

}  // namespace
}  // namespace curbstone::tensor_voting::worker
