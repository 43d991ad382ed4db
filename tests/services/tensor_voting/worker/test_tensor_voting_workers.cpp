#include <gtest/gtest.h>

#include "tests/services/tensor_voting/worker/tensor_voting_world.hpp"

namespace curbstone::tensor_voting::worker {
namespace {

TEST(TensorVotingWorkers, TwoWorkersShareTheTilesAndTogetherEqualOne) {
  World world(street());
  TensorVotingNode& one = world.start("tensor_voting:1");
  TensorVotingNode& two = world.start("tensor_voting:3");
  world.run(3);  // they hear of each other
  world.run(3, 0.1);
  world.run(3);
  EXPECT_EQ(world.listener.contents(), lossless());
  const auto published = [](const TensorVotingNode& node) { return node.report().counters["tiles_published"]; };
  EXPECT_GT(published(one), 0);
  EXPECT_GT(published(two), 0);
  EXPECT_EQ(world.listener.indexes.size(), 2U);
}

TEST(TensorVotingWorkers, TilesOfADeadWorkerMoveWithinThreeSeconds) {
  World world(street());
  world.start("tensor_voting:1");
  world.start("tensor_voting:3");
  world.run(3);
  world.run(1, 0.05);
  world.kill("tensor_voting:3");
  world.run(1, 0.1);
  world.run(2, 0.0);
  const auto moved = world.nodes["tensor_voting:1"]->report().counters["reassignments"];
  EXPECT_EQ(moved, 2) << "one came, one went";
  world.mapper.map(world.now, 1.0);
  world.run(3);
  EXPECT_EQ(world.listener.contents(), lossless());
}

TEST(TensorVotingWorkers, AWorkerThatStartsLateCatchesUpAndTakesItsShare) {
  World world(street());
  world.start("tensor_voting:1");
  world.run(2, 0.02);
  TensorVotingNode& late = world.start("tensor_voting:3");
  world.run(4);
  world.kill("tensor_voting:1");
  world.run(4);
  world.mapper.map(world.now, 1.0);
  world.run(3);
  EXPECT_EQ(world.listener.contents(), lossless()) << "it had asked for the map that it missed";
  EXPECT_GT(late.report().counters["tiles_published"], 0);
}

TEST(TensorVotingWorkers, AWorkerThatStartsLateSaysNothingBeforeItKnowsTheMap) {
  World world(street());
  world.start("tensor_voting:1");
  world.run(2, 0.02);
  TensorVotingNode& late = world.start("tensor_voting:3");
  std::size_t known = 0;
  for (int i = 0; i < 400 && world.listener.indexes["tensor_voting:3"] == 0; ++i) {
    known = static_cast<std::size_t>(late.report().counters["map_points"]);
    world.run(0.02, 0.001);
  }
  EXPECT_EQ(world.listener.indexes["tensor_voting:3"], 1) << "at last it lives";
  EXPECT_GT(known, world.mapper.mapped() * 9 / 10) << "nobody lets go of a tile for one who does not know it";
}

TEST(TensorVotingWorkers, AWorkerThatStartsLateJoinsThoughTheMapGrowsAndMessagesAreLost) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    World world(street(), 0.2, seed);
    world.start("tensor_voting:1");
    world.run(3, 0.002);
    world.start("tensor_voting:3");
    world.run(6, 0.002);
    EXPECT_GT(world.listener.indexes["tensor_voting:3"], 0) << "of what is mapped, something is always on its way";
  }
}

TEST(TensorVotingWorkers, PointsThatComeBesideTheFirstSignOfAnotherWorkerAreVotedOnBeforeTheyGoOut) {
  TensorVotingConfig slow;
  slow.bandwidth = 0.1;  // MB/s: there is always a tile that waits to go out
  World world(street(), 0, 1, slow);
  TensorVotingNode& one = world.start("tensor_voting:1");
  world.run(3, 0.02);
  tile_index_t heartbeat{};
  heartbeat.owner = "tensor_voting:3";
  heartbeat.channel = "VOTED_POINTS";
  heartbeat.num_pages = 1;
  heartbeat.epoch = 1;
  world.bus.publish("TILE_INDEX", heartbeat);
  world.mapper.map(world.now, 0.1);
  world.bus.dispatch();
  for (int i = 0; i < 20; ++i) one.caught_up(world.now += 50'000);
  world.bus.dispatch();
  world.mapper.map(world.now, 1.0);
  world.run(60);
  EXPECT_EQ(world.listener.contents(), lossless());
}

TEST(TensorVotingWorkers, VotesOnItsOwnTilesAndTheirMarginOnly) {
  World world(street());
  TensorVotingNode& one = world.start("tensor_voting:1");
  TensorVotingNode& two = world.start("tensor_voting:3");
  world.run(3);
  world.run(2, 0.1);
  world.run(3);
  const auto pairs = [](const TensorVotingNode& node) { return node.report().counters["pair_votes"]; };
  World alone(street());
  TensorVotingNode& all = alone.start("tensor_voting:1");
  alone.run(0.1, 1.0);
  EXPECT_LT(pairs(one), pairs(all));
  EXPECT_LT(pairs(two), pairs(all));
  EXPECT_GT(pairs(one) + pairs(two), pairs(all)) << "votes across the border are for both";
  EXPECT_EQ(world.listener.contents(), lossless());
}

}  // namespace
}  // namespace curbstone::tensor_voting::worker
