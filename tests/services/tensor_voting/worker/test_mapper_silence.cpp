#include <gmock/gmock.h>

#include "services/tensor_voting/worker/tensor_voting_node.hpp"
#include "tests/services/tensor_voting/worker/tensor_voting_world.hpp"

namespace curbstone::tensor_voting::worker {
namespace {

TEST(TensorVotingNode, SaysThatItLivesAndThatTheMapperIsSilent) {
  World world({});
  TensorVotingNode& node = world.start("tensor_voting:1");
  world.kill("nobody");
  node.tick(world.now += kTick);
  EXPECT_TRUE(node.report().faults.empty()) << "the mapper may be starting as well";
  for (int i = 0; i < 500; ++i) node.tick(world.now += kTick);
  world.bus.dispatch();
  EXPECT_GE(world.listener.indexes["tensor_voting:1"], 8) << "the empty index is the heartbeat";
  EXPECT_THAT(node.report().faults, ::testing::ElementsAre("the mapper is silent"));
  world.run(2);
  EXPECT_TRUE(node.report().faults.empty()) << "an empty map is no fault";
}

TEST(TensorVotingNode, DoesNotBlameTheMapperWhenItWasStoppedItself) {
  World world({});
  TensorVotingNode& node = world.start("tensor_voting:1");
  world.run(2);
  world.now += 5'000'000;
  node.tick(world.now += kTick);
  EXPECT_TRUE(node.report().faults.empty()) << "what the mapper said meanwhile waits to be handled";
  for (int i = 0; i < 160; ++i) node.tick(world.now += kTick);
  EXPECT_THAT(node.report().faults, ::testing::ElementsAre("the mapper is silent")) << "since the wake-up";
}

}  // namespace
}  // namespace curbstone::tensor_voting::worker
