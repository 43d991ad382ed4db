#include "drivers/lidar/decoding/block_steps.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace curbstone::lidar::decoding {
namespace {

constexpr int kBlocks = 12;

struct Judged {
  BlockSteps steps;
  std::array<BlockSpan, kBlocks> spans;
};

/// Steps judged from `first` on.
Judged judge(const std::vector<int>& steps, int first = 1000, const BlindZone& blind_zone = {}) {
  std::array<std::uint16_t, kBlocks> azimuths{};
  int azimuth = first;
  for (std::size_t i = 0; i < kBlocks; ++i) {
    azimuths[i] = static_cast<std::uint16_t>((azimuth + 36000) % 36000);
    if (i < steps.size()) azimuth += steps[i];
  }
  Judged judged;
  judged.steps = block_steps(azimuths, blind_zone, 1.0, judged.spans);
  return judged;
}

std::vector<int> even_steps(int step = 40) {
  return std::vector<int>(kBlocks - 1, step);
}

TEST(BlockSteps, TurnToTheNextBlockAndByTheMeanInTheLast) {
  auto steps = even_steps();
  steps[1] = 41;
  const Judged judged = judge(steps);
  ASSERT_TRUE(judged.steps.steady);
  EXPECT_DOUBLE_EQ(judged.steps.mean, 441.0 / 11);
  EXPECT_EQ(judged.spans[0].angle, 40);
  EXPECT_EQ(judged.spans[1].angle, 41);
  EXPECT_DOUBLE_EQ(judged.spans[11].angle, 441.0 / 11);
  EXPECT_EQ(judged.spans[11].start, 11);
}

TEST(BlockSteps, PassZero) {
  const Judged judged = judge(even_steps(), 35700);
  ASSERT_TRUE(judged.steps.steady);
  EXPECT_EQ(judged.spans[7].angle, 40);
}

TEST(BlockSteps, AreNotThoseOfAHeadWhereItStandsOrItsAzimuthIsStuck) {
  auto steps = even_steps(0);
  EXPECT_FALSE(judge(steps, 0).steps.steady);
  steps[2] = -1;
  steps[3] = 1;
  EXPECT_FALSE(judge(steps, 0).steps.steady) << "it jitters";
  steps = even_steps(9);  // two returns, 5 Hz, 50 us a sequence
  steps[3] = 0;
  EXPECT_FALSE(judge(steps).steps.steady);
  steps[3] = 8;
  EXPECT_TRUE(judge(steps).steps.steady);
}

TEST(BlockSteps, FindOneDamagedAzimuthWhereverItIs) {
  for (int block = 0; block < kBlocks; ++block) {
    for (const int off : {9000, -9000, 18000, 300, -300, 50, -50, 11, -11}) {
      auto steps = even_steps();
      int first = 1000;
      if (block == 0) first += off;
      if (block > 0) steps[static_cast<std::size_t>(block) - 1] += off;
      if (block < kBlocks - 1) steps[static_cast<std::size_t>(block)] -= off;
      EXPECT_FALSE(judge(steps, first).steps.steady) << off << " in block " << block;
    }
  }
}

TEST(BlockSteps, TakeABlindZoneForOneOnlyWhereTheDeviceSaysSo) {
  auto steps = even_steps();
  steps[4] = 9040;  // from 11.60 to 102.00 deg
  EXPECT_FALSE(judge(steps).steps.steady);
  BlindZone zone;
  zone.set_field_of_view(10200, 1160);
  const Judged judged = judge(steps, 1000, zone);
  ASSERT_TRUE(judged.steps.steady);
  EXPECT_EQ(judged.spans[4].angle, 40) << "not to the other side of the zone";
  EXPECT_DOUBLE_EQ(judged.spans[5].start, 4 + 9040.0 / 40.0) << "the time to pass the zone";
  zone.set_field_of_view(20200, 11160);
  EXPECT_FALSE(judge(steps, 1000, zone).steps.steady) << "as wide, but elsewhere";
}

TEST(BlockSteps, AreNotThoseOfAHeadWhereTheyAreAllDifferentOrTooLarge) {
  EXPECT_FALSE(judge(even_steps(101)).steps.steady);
  EXPECT_FALSE(judge(even_steps(-20)).steps.steady);
  EXPECT_FALSE(judge({10, 500, 3000, 20, 700, 40, 90, 5000, 60, 10, 9}).steps.steady);
}

TEST(BlindZone, IsLearntWhereItComesTwiceAndTheTimePassed) {
  const Gap gap{1160, 9040};
  for (const bool waits : {true, false}) {
    BlindZone zone;
    for (int turn = 0; turn < 2; ++turn) {
      const std::int64_t stamp = 1'000'000 + turn * 100'000;
      EXPECT_FALSE(zone.is(gap));
      zone.suspect(gap, stamp, 1332, 26'000);
      zone.next_stamp(stamp + (waits ? 26'000 : 1332));
    }
    EXPECT_EQ(zone.is(gap), waits);
    EXPECT_FALSE(zone.is({9160, 9040}));
  }
}

}  // namespace
}  // namespace curbstone::lidar::decoding
