#include <gtest/gtest.h>

#include <cmath>

#include "tools/simulate/numerics/random.hpp"
#include "tools/simulate/world/town.hpp"

namespace curbstone::simulate::world {
namespace {

TEST(Scene, FindsTheSameShapeAsTryingAllOfThem) {
  const world::Town town({.seed = 3});
  const world::Scene& scene = *town.scene;
  const world::Street& loop = town.streets.front();
  numerics::Random random(1);
  for (int i = 0; i < 3000; ++i) {
    const Eigen::Vector2d p = loop.at(random.uniform(0, loop.length())).point;
    const auto x = static_cast<float>(p.x()), y = static_cast<float>(p.y());
    const double heading = random.uniform(0, 2 * M_PI), up = random.uniform(-0.26, 0.26);
    world::Ray ray;
    ray.origin = {x, y, scene.ground().height_at(x, y) + 1.73F};
    ray.direction =
        Eigen::Vector3d(std::cos(heading) * std::cos(up), std::sin(heading) * std::cos(up), std::sin(up)).cast<float>();
    const auto noise = random.bits();
    world::Hit all;
    all.range = 150;
    for (std::uint32_t k = 0; k < scene.shapes().size(); ++k)
      world::intersect(scene.shapes()[k], ray, numerics::mix_bits(noise ^ k), all);
    const world::Hit found = scene.cast(ray, 150, {}, noise);
    // The ground may be nearer; a shape may not be missed, nor found where there is none.
    if (found.surface >= world::Surface::kWall) {
      EXPECT_FLOAT_EQ(found.range, all.range);
    } else if (found.surface != world::Surface::kNone) {
      EXPECT_LE(found.range, all.range);
    } else {
      EXPECT_EQ(all.surface, world::Surface::kNone);
    }
  }
}

TEST(Scene, SeesMovingThings) {
  const world::Town town({.seed = 1});
  const auto at = town.streets.front().at(10.0);
  const auto x = static_cast<float>(at.point.x()), y = static_cast<float>(at.point.y());
  const float z = town.scene->ground().height_at(x, y) + 1.0F;
  const Eigen::Vector3f ahead(static_cast<float>(at.tangent.x()), static_cast<float>(at.tangent.y()), 0);
  const Eigen::Vector3f centre = Eigen::Vector3f(x, y, z) + 5 * ahead;
  const world::Shape car = world::make_box(world::Surface::kCar, 0.5F, centre.cast<double>(), {2, 2, 2},
                                           std::atan2(at.tangent.y(), at.tangent.x()));
  EXPECT_NEAR(town.scene->cast({{x, y, z}, ahead}, 100, {&car, 1}, 0).range, 4.0F, 1e-3F);
}

}  // namespace
}  // namespace curbstone::simulate::world
