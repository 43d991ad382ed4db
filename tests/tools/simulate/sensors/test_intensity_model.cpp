#include "tools/simulate/sensors/intensity_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "tools/simulate/numerics/random.hpp"

namespace curbstone::simulate::sensors {
namespace {

constexpr float kAsphalt = 0.14F, kPaint = 0.55F;

/// Of 400 returns of one laser: the share that are 0, and the median of the others.
struct Returns {
  double zeros = 0;
  int median = 0;
};

Returns returns_of(const IntensityModel& model, int laser, float reflectivity) {
  const world::Hit hit{10.0F, 0.15F, reflectivity, world::Surface::kAsphalt};
  std::vector<int> values;
  Returns returns;
  for (std::uint64_t i = 0; i < 400; ++i) {
    const int value = model.report(hit, reflectivity, laser, numerics::mix_bits(i));
    if (value == 0) {
      returns.zeros += 1.0 / 400;
    } else {
      values.push_back(value);
    }
  }
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  returns.median = values[values.size() / 2];
  return returns;
}

TEST(IntensityModel, GivesEveryLaserAScaleOfItsOwn) {
  int lowest = 255, highest = 0;
  for (int laser = 0; laser < 16; ++laser) {
    const Returns road = returns_of({}, laser, kAsphalt), paint = returns_of({}, laser, kPaint);
    lowest = std::min(lowest, road.median);
    highest = std::max(highest, road.median);
    EXPECT_GT(paint.median, 2 * road.median) << laser;
    EXPECT_GT(road.zeros, 0.01) << laser;
    EXPECT_LT(road.zeros, 0.5) << laser;
  }
  EXPECT_LT(lowest, 16);
  EXPECT_GT(highest, 80);
}

TEST(IntensityModel, WithoutGainsOfRingsIsTheSameForAllLasersAndNeverZero) {
  const IntensityModel even{.ring_gains = false};
  for (int laser = 0; laser < 16; ++laser) {
    const Returns road = returns_of(even, laser, kAsphalt);
    EXPECT_NEAR(road.median, 64, 2);
    EXPECT_EQ(road.zeros, 0.0);
  }
}

TEST(IntensityModel, ComesInStepsIfAskedTo) {
  const IntensityModel coarse{.ring_gains = false, .step = 16};
  const world::Hit hit{10.0F, 0.15F, kAsphalt, world::Surface::kAsphalt};
  for (std::uint64_t i = 0; i < 100; ++i) EXPECT_EQ(coarse.report(hit, kAsphalt, 0, numerics::mix_bits(i)) % 16, 0);
}

}  // namespace
}  // namespace curbstone::simulate::sensors
