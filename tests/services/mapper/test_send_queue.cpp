#include "services/mapper/send_queue.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <vector>

namespace curbstone::mapper {
namespace {

using ::testing::ElementsAre;

std::vector<TileKey> popped(SendQueue& queue) {
  std::vector<TileKey> keys;
  while (const auto key = queue.pop()) keys.push_back(*key);
  return keys;
}

TEST(SendQueueTest, TheGroundBeneathTheVehicleGoesFirstHoweverMuchWaits) {
  SendQueue queue;
  queue.set_position(1.5, 1.5);
  for (int x = 100; x > 0; --x) queue.push({x, 0});
  queue.push({0, 0});
  EXPECT_EQ(*queue.pop(), (TileKey{1, 0})) << "the ring of 5 m, in which it came first";
  EXPECT_EQ(*queue.pop(), (TileKey{0, 0}));
  EXPECT_EQ(*queue.pop(), (TileKey{3, 0})) << "the next ring";
  queue.push({0, 0});
  EXPECT_EQ(*queue.pop(), (TileKey{0, 0})) << "what a scan adds there goes before the rest of the map";
}

TEST(SendQueueTest, ARingIsFirstInFirstOut) {
  SendQueue queue;
  for (const int x : {60, 90, 50, 90}) queue.push({x, 0});
  EXPECT_THAT(popped(queue), ElementsAre(TileKey{60, 0}, TileKey{90, 0}, TileKey{50, 0}));
}

TEST(SendQueueTest, WhatTheVehicleComesNearToMovesUpAndGoesOutOnce) {
  SendQueue queue;
  for (int x = 0; x < 100; ++x) queue.push({x, 0});
  queue.set_position(3 * 99.5, 1.5);
  EXPECT_EQ(*queue.pop(), (TileKey{0, 0})) << "stays in the ring that it had";
  const std::vector<TileKey> rest = popped(queue);
  EXPECT_EQ(rest.size(), 99U);
  const auto place = [&](int x) { return std::find(rest.begin(), rest.end(), TileKey{x, 0}) - rest.begin(); };
  EXPECT_LT(place(99), place(90));
  EXPECT_LT(place(90), place(50));
}

}  // namespace
}  // namespace curbstone::mapper
