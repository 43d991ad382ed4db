// A straight street along x whose answers are known by hand.
#include <gtest/gtest.h>

#include <cmath>

#include "tools/simulate/numerics/random.hpp"
#include "tools/simulate/world/ground.hpp"

namespace curbstone::simulate::world {
namespace {

constexpr float kCurb = 0.12F;

/// Crown along y = 0, gutters at |y| = 4.5.
world::Ground straight_street(float slope = 0.0F, const world::StreetProfile& profile = {}) {
  world::Ground ground(-20, -20, 321, 161, profile);
  for (int iy = 0; iy < ground.height(); ++iy) {
    for (int ix = 0; ix < ground.width(); ++ix) {
      const auto distance = static_cast<float>(std::abs(ground.y_of(iy)) - ground.profile().half_width);
      ground.node(ix, iy) = {distance, slope * static_cast<float>(ground.x_of(ix)), kCurb, kCurb};
    }
  }
  ground.finish();
  return ground;
}

TEST(Ground, HasTheCurbsHeightAcrossTheFace) {
  const world::Ground ground = straight_street();
  EXPECT_NEAR(ground.height_at(0, 4.4999F), 0.0F, 1e-4F) << "gutter";
  EXPECT_NEAR(ground.height_at(0, 4.5F + 0.036F), kCurb, 1e-3F) << "top of the curb";
  EXPECT_NEAR(ground.height_at(0, 0), 0.059F, 0.01F) << "crown: a mean fall of some 1.3 % to the gutter";
}

TEST(Ground, IsLowerAtADroppedKerbAndRampsUpBehindIt) {
  world::Ground ground = straight_street();
  for (int iy = 0; iy < ground.height(); ++iy) {
    for (int ix = 0; ix < ground.width(); ++ix) ground.node(ix, iy).curb = 0.02F;
  }
  EXPECT_NEAR(ground.height_at(0, 4.54F), 0.02F, 2e-3F);
  EXPECT_NEAR(ground.height_at(0, 4.5F + 1.3F), kCurb + 0.02F * 1.265F, 1e-3F);
}

TEST(GroundCast, MeetsALevelRoadWhereTrigonometrySays) {
  const world::Ground ground = straight_street();
  // Along the street at y = 0: the road there is level, its height is that of the crown.
  const float crown = ground.height_at(0, 0);
  for (const double degrees : {3.0, 5.0, 9.0, 15.0}) {
    const float slope = -static_cast<float>(std::tan(degrees * M_PI / 180));
    const float u = ground.cast(-10, 0, crown + 1.73F, 1, 0, slope, 60);
    EXPECT_NEAR(u, -1.73F / slope, 0.02F) << degrees;
  }
}

TEST(GroundCast, MeetsASlopingRoadSooner) {
  const world::Ground ground = straight_street(0.04F);
  const float z = ground.height_at(0, 0);
  const float slope = -static_cast<float>(std::tan(7 * M_PI / 180));
  EXPECT_NEAR(ground.cast(0, 0, z + 1.73F, 1, 0, slope, 60), 1.73F / (0.04F - slope), 0.02F);
}

TEST(GroundCast, MeetsTheCurbFaceWhereALevelRayPasses) {
  const world::Ground ground = straight_street();
  // A level ray 6 cm above the gutter, from where the road is lower than that.
  const float u = ground.cast(0, 3.5F, 0.06F, 0, 1, 0, 10);
  // Height 0.06 of 0.12 on a face 1 - (1 - x)^3: x = 1 - 0.5^(1/3)
  EXPECT_NEAR(u, 1.0F + 0.035F * (1 - std::cbrt(0.5F)), 2e-3F);
}

void expect_agreement_with_small_steps(const world::Ground& ground) {
  numerics::Random random(7);
  int compared = 0;
  for (int i = 0; i < 400; ++i) {
    const auto x = static_cast<float>(random.uniform(-8, 8)), y = static_cast<float>(random.uniform(-6, 6));
    const double heading = random.uniform(0, 2 * M_PI), down = random.uniform(1.0, 15.0) * M_PI / 180;
    const auto dx = static_cast<float>(std::cos(heading)), dy = static_cast<float>(std::sin(heading));
    const auto slope = -static_cast<float>(std::tan(down));
    const float z = ground.height_at(x, y) + 1.73F;
    float expected = -1;
    for (float u = 0; u < 25; u += 5e-4F) {
      const float px = x + u * dx, py = y + u * dy;
      if (!ground.inside(static_cast<double>(px), static_cast<double>(py))) break;
      if (z + u * slope < ground.height_at(px, py, true)) {
        expected = u;
        break;
      }
    }
    if (expected < 0) continue;
    ++compared;
    // On lawns a ray may graze a tuft: compare heights there, ranges elsewhere.
    EXPECT_NEAR(ground.cast(x, y, z, dx, dy, slope, 40) * slope, expected * slope, 4e-3F) << i;
  }
  EXPECT_GT(compared, 200);
}

TEST(GroundCast, AgreesWithSmallStepsFromAnywhere) {
  expect_agreement_with_small_steps(straight_street(0.02F));
}

TEST(GroundCast, AgreesWithSmallStepsOnASteepStreet) {
  expect_agreement_with_small_steps(straight_street(0.4F, {.steepness = 0.4}));
}

TEST(GroundCast, SeesNothingAboveTheHorizonOrBeyondTheWorld) {
  const world::Ground ground = straight_street();
  EXPECT_LT(ground.cast(0, 0, 1.8F, 1, 0, 0.1F, 100), 0);
  EXPECT_LT(ground.cast(0, 0, 1.8F, 1, 0, -0.01F, 1000), 0);
}

}  // namespace
}  // namespace curbstone::simulate::world
