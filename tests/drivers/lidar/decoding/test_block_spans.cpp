#include <gtest/gtest.h>

#include <array>

#include "drivers/lidar/decoding/block_spans.hpp"

namespace curbstone::lidar::decoding {
namespace {

std::array<BlockSpan, 3> spans_of(const std::array<std::uint16_t, 3>& azimuths, double nominal) {
  std::array<BlockSpan, 3> spans;
  block_spans(azimuths, nominal, 1.0, spans);
  return spans;
}

// The vectors of rs_driver's test/rs16_single_return_block_iterator_test.cpp.
TEST(BlockSpans, TurnToTheNextBlockAndNominallyInTheLast) {
  const auto spans = spans_of({1, 21, 51}, 50);
  EXPECT_EQ(spans[0].angle, 20);
  EXPECT_EQ(spans[1].angle, 30);
  EXPECT_EQ(spans[2].angle, 50);
  EXPECT_EQ(spans[0].start, 0);
  EXPECT_EQ(spans[1].start, 1);
  EXPECT_EQ(spans[2].start, 2);
}

TEST(BlockSpans, TimePassesInABlindZoneWithoutFiring) {
  const auto spans = spans_of({1, 21, 141}, 60);
  EXPECT_EQ(spans[0].angle, 20);
  EXPECT_EQ(spans[1].angle, 60);  // not the 120 to the other side of the blind zone
  EXPECT_EQ(spans[2].angle, 60);
  EXPECT_EQ(spans[1].start, 1);
  EXPECT_EQ(spans[2].start, 1 + 120.0 / 60.0);
}

TEST(BlockSpans, PassZero) {
  const auto spans = spans_of({35970, 35990, 10}, 20);
  EXPECT_EQ(spans[0].angle, 20);
  EXPECT_EQ(spans[1].angle, 20);
}

TEST(BlockSpans, BearAStandingHeadThatJitters) {
  const auto spans = spans_of({100, 99, 100}, 0);
  EXPECT_EQ(spans[0].angle, -1);
  EXPECT_EQ(spans[1].angle, 1);
  EXPECT_EQ(spans[2].angle, 0);
  EXPECT_EQ(spans[2].start, 2);
}

TEST(MeanBlockStep, LeavesOutBlindZones) {
  const std::array<std::uint16_t, 4> azimuths = {35980, 20, 5000, 5042};
  EXPECT_DOUBLE_EQ(mean_block_step(azimuths, 7), 41);
}

TEST(MeanBlockStep, FallsBackWhereEveryStepIsABlindZone) {
  const std::array<std::uint16_t, 3> azimuths = {0, 500, 1000};
  EXPECT_EQ(mean_block_step(azimuths, 7), 7);
}

}  // namespace
}  // namespace curbstone::lidar::decoding
