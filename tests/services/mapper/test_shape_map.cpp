#include "services/mapper/shape_map.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace curbstone {
namespace {

/// A patch of 0.8 m in the plane of x and y, 10 m ahead: a floor, or what one level ring makes of a hedge.
ShapeLevel patch(const Eigen::Vector3f& ray) {
  ShapeLevel level{ShapeLevelOptions{}};
  for (int i = 0; i < 16; ++i) {
    for (int j = 0; j < 16; ++j) {
      const Eigen::Vector3f p(9.65F + 0.05F * static_cast<float>(i), -0.25F + 0.05F * static_cast<float>(j), 0.1F);
      level.insert(p, ray.normalized());
    }
  }
  level.end_insertion();
  return level;
}

TEST(ShapeLevel, FitsThePlaneOfItsNeighbourhood) {
  ShapeLevel floor = patch({10, 0, -1.7F});
  const MapShape* plane = floor.shape_at({10, 0.1F, 0.15F});
  ASSERT_NE(plane, nullptr);
  EXPECT_NEAR(std::abs(plane->axis.z()), 1, 1e-5);
  EXPECT_NEAR(plane->mean.z(), 0.1F, 1e-5);
}

TEST(ShapeLevel, TheScanPlaneOfARingIsNoSurface) {
  ShapeLevel hedge = patch({10, 0, 0.02F});  // the rays run along what looks like a plane
  EXPECT_EQ(hedge.shape_at({10, 0.1F, 0.15F}), nullptr);
}

TEST(ShapeLevel, ALineIsNoPlane) {
  ShapeLevel level{ShapeLevelOptions{}};
  for (int i = 0; i < 100; ++i) {
    level.insert({10, -0.4F + 0.008F * static_cast<float>(i), 0.1F}, Eigen::Vector3f(10, 0, -1.7F).normalized());
  }
  level.end_insertion();
  EXPECT_EQ(level.shape_at({10, 0.1F, 0.15F}), nullptr);
}

TEST(ShapeLevel, KeepsWhatIsNear) {
  ShapeLevel level{ShapeLevelOptions{}};
  for (int i = 0; i < 1000; ++i) level.insert({static_cast<float>(i), 0, 0}, Eigen::Vector3f::UnitX());
  EXPECT_EQ(level.size(), 1000);
  level.keep_around({500, 0, 0}, 100);
  EXPECT_NEAR(static_cast<double>(level.size()), 200, 2);
}

}  // namespace
}  // namespace curbstone
