#include "services/mapper/registration/shape_map.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace curbstone::mapper::registration {
namespace {

/// A patch of 0.8 m in the plane of x and y, 10 m ahead: a floor, or what one level ring makes of a hedge.
ShapeLevel patch(const Eigen::Vector3f& ray) {
  ShapeLevel level{ShapeLevelOptions{}};
  for (int i = 0; i < 16; ++i) {
    for (int j = 0; j < 16; ++j) {
      const Eigen::Vector3d p(9.65 + 0.05 * i, -0.25 + 0.05 * j, 0.1);
      level.insert(p, ray.normalized());
    }
  }
  level.end_insertion();
  return level;
}

TEST(ShapeLevel, FitsThePlaneOfItsNeighbourhood) {
  ShapeLevel floor = patch({10, 0, -1.7F});
  const MapShape* plane = floor.shape_at({10, 0.1, 0.15});
  ASSERT_NE(plane, nullptr);
  EXPECT_NEAR(std::abs(plane->axis.z()), 1, 1e-5);
  EXPECT_NEAR(plane->mean.z(), 0.1, 1e-5);
}

TEST(ShapeLevel, TheScanPlaneOfARingIsNoSurface) {
  ShapeLevel hedge = patch({10, 0, 0.02F});  // the rays run along what looks like a plane
  EXPECT_EQ(hedge.shape_at({10, 0.1, 0.15}), nullptr);
}

TEST(ShapeLevel, ALineIsNoPlane) {
  ShapeLevel level{ShapeLevelOptions{}};
  for (int i = 0; i < 100; ++i) {
    level.insert({10, -0.4 + 0.008 * i, 0.1}, Eigen::Vector3f(10, 0, -1.7F).normalized());
  }
  level.end_insertion();
  EXPECT_EQ(level.shape_at({10, 0.1, 0.15}), nullptr);
}

TEST(ShapeLevel, KeepsWhatIsNear) {
  ShapeLevel level{ShapeLevelOptions{}};
  for (int i = 0; i < 1000; ++i) level.insert({static_cast<double>(i), 0, 0}, Eigen::Vector3f::UnitX());
  EXPECT_EQ(level.size(), 1000);
  level.keep_around({500, 0, 0}, 100);
  EXPECT_NEAR(static_cast<double>(level.size()), 200, 2);
}

}  // namespace
}  // namespace curbstone::mapper::registration
