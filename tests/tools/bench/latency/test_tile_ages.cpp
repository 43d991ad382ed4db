#include "tools/bench/latency/tile_ages.hpp"

#include <gtest/gtest.h>

#include <curbstone/map_points_t.hpp>
#include <curbstone/semantic_tile_t.hpp>

namespace curbstone::bench::latency {
namespace {

constexpr std::int64_t kSecond = 1'000'000;

template <class Message>
TimedMessage sent(const char* channel, const Message& message, std::int64_t at) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return {at, channel, std::make_shared<const std::vector<std::uint8_t>>(std::move(bytes))};
}

TEST(TileAges, WhatANewEpochMovesIntoAnotherTileIsNotOld) {
  TileAges ages;
  map_points_t points{};
  semantic_tile_t tile{};
  const auto map = [&](int epoch, int x, std::int64_t measured, std::int64_t at) {
    points.epoch = tile.epoch = epoch;
    points.tile_x = tile.tile_x = x;
    points.utime = tile.utime = tile.curbs_utime = measured;
    ages.on_message(sent("MAP_POINTS", points, at));
    ages.on_message(sent("SEMANTIC_TILE", tile, at + 10'000));
  };
  map(1, 0, 10 * kSecond, 10 * kSecond + 10'000);
  map(1, 1, 40 * kSecond, 40 * kSecond + 20'000);
  map(2, 0, 40 * kSecond, 90 * kSecond);  // a loop was closed: what tile 1 had is in tile 0 now
  map(2, 0, 91 * kSecond, 91 * kSecond + 50'000);
  EXPECT_EQ(ages.age("SEMANTIC_TILE").count, 3U);
  EXPECT_NEAR(ages.age("SEMANTIC_TILE").max, 60, 1e-9);
  EXPECT_NEAR(ages.age("MAP_POINTS").max, 50, 1e-9);
  EXPECT_NEAR(ages.news().max, 60, 1e-9);
  EXPECT_NEAR(ages.curb_news().max, 60, 1e-9);
  ages = ages.next_part();
  map(2, 7, 41 * kSecond, 93 * kSecond);  // the last of what was sent again
  EXPECT_EQ(ages.age("SEMANTIC_TILE").count, 0U);
}

}  // namespace
}  // namespace curbstone::bench::latency
