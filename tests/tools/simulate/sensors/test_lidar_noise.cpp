#include <gtest/gtest.h>

#include <cmath>

#include "tools/simulate/numerics/random.hpp"
#include "tools/simulate/sensors/lidar_noise.hpp"

namespace curbstone::simulate::sensors {
namespace {

TEST(LidarNoise, SpreadsRangesAsConfigured) {
  sensors::LidarNoise noise;
  noise.mixed_pixels = 0;
  const world::Hit wall{10.0F, 1.0F, 0.5F, world::Surface::kWall};
  double sum = 0, squares = 0;
  int n = 0;
  for (std::uint64_t i = 0; i < 20'000; ++i) {
    const devices::LidarShot shot = noise.report(wall, numerics::mix_bits(i));
    if (shot.range_m <= 0) continue;
    const double off = static_cast<double>(shot.range_m) - 10.0;
    sum += off;
    squares += off * off;
    ++n;
  }
  EXPECT_NEAR(n, 20'000 * (1 - noise.drop_out), 100);
  EXPECT_NEAR(sum / n, 0.0, 3e-4);
  EXPECT_NEAR(std::sqrt(squares / n), noise.range_sigma, 5e-4);
}

TEST(LidarNoise, LosesDarkFarAndVeryNearThings) {
  const sensors::LidarNoise noise;
  int dark = 0, bright = 0, near = 0;
  for (std::uint64_t i = 0; i < 500; ++i) {
    dark += noise.report({100.0F, 1.0F, 0.05F, world::Surface::kCar}, numerics::mix_bits(i)).range_m > 0 ? 1 : 0;
    bright += noise.report({100.0F, 1.0F, 0.9F, world::Surface::kWall}, numerics::mix_bits(i)).range_m > 0 ? 1 : 0;
    near += noise.report({0.3F, 1.0F, 0.9F, world::Surface::kWall}, numerics::mix_bits(i)).range_m > 0 ? 1 : 0;
  }
  EXPECT_EQ(dark, 0);
  EXPECT_GT(bright, 450);
  EXPECT_EQ(near, 0);
}

TEST(LidarNoise, ReportsNothingWhereNothingIs) {
  EXPECT_EQ(sensors::LidarNoise{}.report(world::Hit{}, 1).range_m, 0.0F);
}

}  // namespace
}  // namespace curbstone::simulate::sensors
