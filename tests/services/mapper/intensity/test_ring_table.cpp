#include "services/mapper/intensity/ring_table.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace curbstone::mapper::intensity {
namespace {

/// A road as a laser of that gain and offset sees it, whose values are multiples of `step`; some of it is paint.
RingHistograms::Counts road(double gain, double offset, double step = 1) {
  RingHistograms::Counts counts{};
  for (int i = -300; i <= 300; ++i) {
    const double power = i > 285 ? 3.0 : 1.0 + 0.0005 * i;  // uniform, then paint
    const double value = std::clamp(step * std::round((offset + gain * power) / step), 0.0, 255.0);
    counts[static_cast<std::size_t>(value)] += 5;
  }
  return counts;
}

TEST(RingTable, PutsTheRoadsMedianAndQuartilesWhereTheyBelong) {
  struct Laser {
    double gain, offset;
    [[nodiscard]] std::uint8_t at(double power) const {
      return static_cast<std::uint8_t>(std::lround(offset + gain * power));
    }
  };
  const std::vector<Laser> lasers = {{100, -20}, {60, 0}, {200, -100}};
  RingHistograms seen;
  for (const Laser& laser : lasers) seen.rings.push_back(road(laser.gain, laser.offset));
  const RingTable table(seen);
  EXPECT_EQ(table.count(RingState::kLearned), 3);
  for (std::uint8_t ring = 0; ring < 3; ++ring) {
    EXPECT_NEAR(table.of(ring, lasers[ring].at(1)), 64, 1) << int{ring};
    EXPECT_NEAR(table.of(ring, lasers[ring].at(1.075)) - table.of(ring, lasers[ring].at(0.925)), 16, 3) << int{ring};
  }
}

TEST(RingTable, RisesWithIntensityAndKeepsZeroForNone) {
  RingHistograms seen;
  seen.rings.push_back(road(60, 0));
  const RingTable table(seen);
  EXPECT_EQ(table.of(0, 0), 0);
  EXPECT_GE(table.of(0, 1), 1);
  for (int raw = 2; raw < 256; ++raw)
    EXPECT_GE(table.of(0, static_cast<std::uint8_t>(raw)), table.of(0, static_cast<std::uint8_t>(raw - 1)));
}

TEST(RingTable, FindsAMedianBetweenCoarseSteps) {
  RingHistograms seen;
  for (const double offset : {0.0, 0.6, 1.2, 1.8}) seen.rings.push_back(road(30, offset, 2.55));
  const RingTable table(seen);
  for (std::uint8_t ring = 0; ring < 4; ++ring) {
    double sum = 0, n = 0;  // of the road, back on the scale
    for (std::size_t raw = 1; raw < 50; ++raw) {
      sum += table.of(ring, static_cast<std::uint8_t>(raw)) * static_cast<double>(seen.rings[ring][raw]);
      n += static_cast<double>(seen.rings[ring][raw]);
    }
    EXPECT_NEAR(sum / n, 64, 3) << int{ring};
  }
}

TEST(RingTable, HasNothingOfARingThatCannotTell) {
  RingHistograms seen;
  seen.rings.resize(4);
  seen.rings[0][0] = 5000;  // dead
  seen.rings[0][9] = 100;
  seen.rings[1][255] = 5000;  // saturated
  seen.rings[2][60] = 100;    // hardly seen
  seen.rings[3] = road(60, 0);
  seen.rings[3][0] += 1200;  // as lasers are: two in five are lost
  const RingTable table(seen);
  EXPECT_EQ(table.state(0), RingState::kDead);
  EXPECT_EQ(table.state(1), RingState::kSaturated);
  EXPECT_EQ(table.state(2), RingState::kUnknown);
  EXPECT_EQ(table.state(3), RingState::kLearned);
  EXPECT_EQ(table.state(200), RingState::kUnknown);
  for (const int ring : {0, 1, 2, 200}) EXPECT_EQ(table.of(static_cast<std::uint8_t>(ring), 60), 0);
  EXPECT_NEAR(table.of(3, 60), 64, 1);
}

TEST(RingTable, DoesNotBlowUpARoadWithoutTexture) {
  RingHistograms seen;
  seen.rings.resize(1);
  seen.rings[0][80] = 1000;
  EXPECT_NEAR(RingTable(seen).of(0, 88), 64 + 16, 1) << "a tenth brighter is a spread of quartiles at most";
}

}  // namespace
}  // namespace curbstone::mapper::intensity
