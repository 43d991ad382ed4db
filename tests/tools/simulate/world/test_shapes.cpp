// Analytic answers for rays against boxes, cylinders and ellipsoids.
#include <gtest/gtest.h>

#include <cmath>

#include "tools/simulate/world/shapes.hpp"

namespace curbstone::simulate::world {
namespace {

world::Hit cast(const world::Shape& shape, const Eigen::Vector3f& from, const Eigen::Vector3f& towards,
                float reach = 100.0F) {
  world::Hit hit;
  hit.range = reach;
  world::intersect(shape, {from, towards.normalized()}, 0, hit);
  return hit;
}

TEST(Box, IsMetAtItsNearFaceHeadOn) {
  const world::Shape box = world::make_box(world::Surface::kWall, 0.5F, {10, 0, 1}, {2, 4, 2}, 0);
  const world::Hit hit = cast(box, {0, 0, 1}, {1, 0, 0});
  EXPECT_FLOAT_EQ(hit.range, 9.0F);
  EXPECT_FLOAT_EQ(hit.incidence, 1.0F);
  EXPECT_EQ(hit.surface, world::Surface::kWall);
}

TEST(Box, TurnedByFortyFiveDegreesIsMetAtItsEdge) {
  const world::Shape box = world::make_box(world::Surface::kWall, 0.5F, {10, 0, 1}, {2, 2, 2}, M_PI / 4);
  EXPECT_NEAR(cast(box, {0, 0, 1}, {1, 0, 0}).range, 10.0F - std::sqrt(2.0F), 1e-5F);
}

TEST(Box, IsMissedAboveBesideAndBehind) {
  const world::Shape box = world::make_box(world::Surface::kWall, 0.5F, {10, 0, 1}, {2, 4, 2}, 0);
  EXPECT_EQ(cast(box, {0, 0, 2.1F}, {1, 0, 0}).surface, world::Surface::kNone);
  EXPECT_EQ(cast(box, {0, 2.1F, 1}, {1, 0, 0}).surface, world::Surface::kNone);
  EXPECT_EQ(cast(box, {0, 0, 1}, {-1, 0, 0}).surface, world::Surface::kNone);
  EXPECT_EQ(cast(box, {0, 0, 1}, {1, 0, 0}, 8.9F).surface, world::Surface::kNone) << "something nearer was hit before";
}

TEST(Cylinder, IsMetAtItsNearSide) {
  const world::Shape pole = world::make_cylinder(world::Surface::kPole, 0.5F, {5, 0, 0}, 0.1, 4);
  EXPECT_NEAR(cast(pole, {0, 0, 1}, {1, 0, 0}).range, 4.9F, 1e-5F);
  // Off the axis by 0.06: 5 - sqrt(0.1^2 - 0.06^2)
  EXPECT_NEAR(cast(pole, {0, 0.06F, 1}, {1, 0, 0}).range, 5.0F - 0.08F, 1e-4F);
  EXPECT_EQ(cast(pole, {0, 0, 4.1F}, {1, 0, 0}).surface, world::Surface::kNone);
  EXPECT_EQ(cast(pole, {0, 0.11F, 1}, {1, 0, 0}).surface, world::Surface::kNone);
}

TEST(Ellipsoid, IsMetAtOrBehindItsSurfaceAsLeavesLetLightThrough) {
  const world::Shape crown = world::make_ellipsoid(world::Surface::kFoliage, 0.3F, {10, 0, 4}, {2, 2, 1});
  int met = 0;
  for (std::uint64_t noise = 0; noise < 200; ++noise) {
    world::Hit hit;
    hit.range = 100;
    world::intersect(crown, {{0, 0, 4}, {1, 0, 0}}, noise << 54, hit);
    if (hit.surface == world::Surface::kNone) continue;
    ++met;
    EXPECT_GE(hit.range, 8.0F - 1e-4F);
    EXPECT_LE(hit.range, 12.0F + 1e-4F);
  }
  EXPECT_GT(met, 150);
  EXPECT_EQ(cast(crown, {0, 0, 2.9F}, {1, 0, 0}).surface, world::Surface::kNone);
}

TEST(Shape, CoversWhatIsAboveItInPlan) {
  const world::Shape box = world::make_box(world::Surface::kCar, 0.5F, {0, 0, 1}, {4, 2, 2}, M_PI / 2);
  EXPECT_TRUE(box.covers(0.9F, 1.9F));
  EXPECT_FALSE(box.covers(1.9F, 0.9F));
  EXPECT_TRUE(box.covers(1.05F, 0.0F, 0.1F));
}

}  // namespace
}  // namespace curbstone::simulate::world
