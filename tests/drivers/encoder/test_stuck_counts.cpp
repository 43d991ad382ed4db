#include "drivers/encoder/stuck_counts.hpp"

#include <gtest/gtest.h>

namespace curbstone::encoder {
namespace {

constexpr std::int64_t kStep = 10'000;  // us

struct Stream {
  StuckCounts watch{4096};
  std::int64_t time = 0;
  void run(double seconds, std::array<int, 2> counts_a_step, const std::optional<StuckCounts::Speeds>& speeds) {
    for (const std::int64_t end = time + static_cast<std::int64_t>(seconds * 1e6); time < end; time += kStep) {
      for (std::size_t i = 0; i < 2; ++i) counts[i] += counts_a_step[i];
      watch.add(time, counts, speeds);
    }
  }
  std::array<std::int32_t, 2> counts{};
};

TEST(StuckCountsTest, ACountThatStandsWhileTheWheelTurnsIsStuckAfterASecond) {
  Stream stream;
  stream.run(5, {65, -65}, StuckCounts::Speeds{955, -955});
  EXPECT_FALSE(stream.watch.stuck(0) || stream.watch.stuck(1));
  stream.run(0.9, {0, -65}, StuckCounts::Speeds{955, -955});
  EXPECT_FALSE(stream.watch.stuck(0));
  stream.run(0.3, {0, -65}, StuckCounts::Speeds{955, -955});
  EXPECT_TRUE(stream.watch.stuck(0));
  EXPECT_FALSE(stream.watch.stuck(1));
  EXPECT_EQ(stream.watch.faults().size(), 1U);
  stream.run(0.02, {65, -65}, StuckCounts::Speeds{955, -955});
  EXPECT_FALSE(stream.watch.stuck(0));
}

TEST(StuckCountsTest, AWheelThatStandsOrWhoseSpeedIsNotKnownIsNot) {
  Stream stream;
  stream.run(60, {0, 0}, StuckCounts::Speeds{0, 19});
  EXPECT_FALSE(stream.watch.stuck(0) || stream.watch.stuck(1));
  stream.run(60, {0, 0}, std::nullopt);
  EXPECT_FALSE(stream.watch.stuck(0) || stream.watch.stuck(1));
}

TEST(StuckCountsTest, ACoarseEncoderHasTimeToCount) {
  Stream stream;
  stream.watch = StuckCounts(16);
  stream.run(6, {0, 0}, StuckCounts::Speeds{25, 25});  // 2.5 rpm: a count each 1.5 s
  EXPECT_FALSE(stream.watch.stuck(0));
  stream.run(8, {0, 0}, StuckCounts::Speeds{25, 25});
  EXPECT_TRUE(stream.watch.stuck(0));
}

}  // namespace
}  // namespace curbstone::encoder
