#include "common/tiles/lru_order.hpp"

#include <gtest/gtest.h>

namespace curbstone {
namespace {

TEST(LruOrder, GivesTheTilesThatWereNotUsedSinceTheOldestFirst) {
  LruOrder order;
  order.used({1, 0}, 10);
  order.used({2, 0}, 20);
  order.used({3, 0}, 30);
  order.used({1, 0}, 40);
  EXPECT_EQ(order.take_unused(20, 50), (TileKey{2, 0}));
  EXPECT_EQ(order.take_unused(20, 50), (TileKey{3, 0}));
  EXPECT_EQ(order.take_unused(20, 50), std::nullopt);
  EXPECT_EQ(order.size(), 1U);
  EXPECT_EQ(order.take_unused(20, 60), (TileKey{1, 0}));
  EXPECT_EQ(order.take_unused(20, 60), std::nullopt);
}

TEST(LruOrder, WhatWasUsedBeforeTheClockWasSetBackIsUnused) {
  LruOrder order;
  order.used({1, 0}, 1000);
  order.used({2, 0}, 10);
  EXPECT_EQ(order.take_unused(20, 15), (TileKey{1, 0}));
  EXPECT_EQ(order.take_unused(20, 15), std::nullopt);
}

TEST(LruOrder, KnowsNothingOfATileThatWasErased) {
  LruOrder order;
  order.used({1, 0}, 10);
  order.used({2, 0}, 10);
  order.erase({1, 0});
  order.erase({7, 7});
  EXPECT_FALSE(order.contains({1, 0}));
  EXPECT_TRUE(order.contains({2, 0}));
  EXPECT_EQ(order.take_unused(1, 11), (TileKey{2, 0}));
  order.used({1, 0}, 12);
  order.clear();
  EXPECT_EQ(order.take_unused(1, 100), std::nullopt);
}

}  // namespace
}  // namespace curbstone
