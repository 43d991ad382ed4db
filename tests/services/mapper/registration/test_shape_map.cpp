#include "services/mapper/registration/shape_map.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <span>
#include <vector>

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

/// Points about the origin, several in many voxels, with gaps.
struct Cloud {
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector3f> rays;

  explicit Cloud(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> along(-6, 6), off(-0.02, 0.02);
    for (int i = 0; i < 5000; ++i) {
      const double x = along(random), y = along(random);
      points.emplace_back(x, y, (x > 2 ? 0.2 * x : 0.0) + off(random));
      rays.push_back(Eigen::Vector3d(x - 10, y, -2).cast<float>().normalized());
    }
  }
};

TEST(ShapeLevel, PointsTogetherAreThePointsOneByOne) {
  ShapeLevel together{ShapeLevelOptions{}}, single{ShapeLevelOptions{}};
  for (const unsigned seed : {1U, 2U}) {
    const Cloud cloud(seed);
    together.insert(cloud.points, cloud.rays);
    for (std::size_t i = 0; i < cloud.points.size(); ++i) single.insert(cloud.points[i], cloud.rays[i]);
    together.end_insertion(), single.end_insertion();
  }
  ASSERT_EQ(together.size(), single.size());
  const Cloud sought(3);
  std::array<ShapeLevel::Place, ShapeLevel::kTogether> places;
  std::size_t found = 0;
  for (std::size_t begin = 0; begin + places.size() <= sought.points.size(); begin += places.size()) {
    together.find(std::span(sought.points).subspan(begin, places.size()), places);
    for (std::size_t i = 0; i < places.size(); ++i) {
      const MapShape* const here = together.shape_at(sought.points[begin + i], places[i]);
      const MapShape* const there = single.shape_at(sought.points[begin + i]);
      ASSERT_EQ(here == nullptr, there == nullptr);
      if (here == nullptr) continue;
      ++found;
      ASSERT_EQ(here->mean, there->mean);
      ASSERT_EQ(here->axis, there->axis);
      ASSERT_EQ(here->variance, there->variance);
    }
  }
  EXPECT_GT(found, 1000U);
}

}  // namespace
}  // namespace curbstone::mapper::registration
