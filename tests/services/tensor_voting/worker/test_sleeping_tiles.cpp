#include <gtest/gtest.h>

#include <map>
#include <utility>

#include "services/tensor_voting/voting/voting_field.hpp"
#include "tests/services/tensor_voting/worker/tensor_voting_world.hpp"

namespace curbstone::tensor_voting::worker {
namespace {

/// Points elsewhere, one by one, until all other tiles have fallen asleep.
void map_elsewhere(World& world) {
  world.run(1e-6 * static_cast<double>(voting::VotingField::kAwake));
  for (int i = 0; i < 1000; ++i) {
    map_points_t message{};
    message.utime = world.now;
    message.epoch = 1;
    message.tile_x = 60;
    message.first = i;
    message.num_points = 1;
    message.x = {static_cast<std::int16_t>(i % kStepsPerTile)};
    message.y = {static_cast<std::int16_t>(100 * (i / kStepsPerTile))};
    message.z = {0};
    message.intensity = {0};
    world.publisher.publish("MAP_POINTS", message);
    if (i % 100 == 0) world.run(0.02);
  }
}

TEST(TensorVotingNode, TilesThatSleptGoOnInStepsToTheSameContent) {
  World world(street());
  world.start("tensor_voting:1");
  std::map<std::pair<int, int>, int> wholes;
  world.bus.subscribe<voted_points_t>("VOTED_POINTS", [&](const voted_points_t& m) {
    if (m.base == 0 && m.page == 0) ++wholes[{m.tile_x, m.tile_y}];
  });
  world.run(1, 0.05);
  map_elsewhere(world);
  world.run(1.5);
  world.run(3, 0.1);
  world.run(2);
  auto contents = world.listener.contents();
  std::erase_if(contents, [](const auto& tile) { return tile.first.x == 60; });
  EXPECT_EQ(contents, lossless());
  EXPECT_EQ(world.listener.gaps, 0);
  for (const auto& [key, count] : wholes) EXPECT_EQ(count, 1) << "the first step";
}

}  // namespace
}  // namespace curbstone::tensor_voting::worker
