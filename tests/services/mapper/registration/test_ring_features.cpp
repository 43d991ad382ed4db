#include "services/mapper/registration/ring_features.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/services/mapper/synthetic_world.hpp"

namespace curbstone::mapper::registration {
namespace {

/// One ring at the height of the lidar inside a square room of 10 m, with a pillar in front.
std::vector<scan::LidarPoint> room() {
  test::SyntheticWorld world;
  world.ground = false;
  world.boxes = {{{5, -6, -1}, {6, 6, 1}},
                 {{-6, -6, -1}, {-5, 6, 1}},
                 {{-6, 5, -1}, {6, 6, 1}},
                 {{-6, -6, -1}, {6, -5, 1}},
                 {{2, -0.5, -1}, {3, 0.5, 1}}};
  std::vector<scan::LidarPoint> points;
  for (int column = 0; column < 900; ++column) {
    const double azimuth = -3.14159265 + 2 * 3.14159265 * (column + 0.5) / 900;
    const Eigen::Vector3d ray(std::cos(azimuth), std::sin(azimuth), 0.001);
    points.push_back({(world.range({0, 0, 0}, ray) * ray).cast<float>(), 1e-4F * static_cast<float>(column), 0, 7});
  }
  return points;
}

float to(const scan::LidarPoint& p, float x, float y) {
  return std::hypot(p.position.x() - x, p.position.y() - y);
}

TEST(RingFeatures, CornersAreEdgesAndWallsArePlanes) {
  const RingFeatures features = ring_features(room(), Eigen::Vector3f::Zero(), config::LoamConfig{});
  for (const auto& [x, y] : {std::pair{5.0F, 5.0F}, {5.0F, -5.0F}, {-5.0F, 5.0F}, {-5.0F, -5.0F}}) {
    EXPECT_TRUE(std::any_of(features.edges.begin(), features.edges.end(),
                            [&](const scan::LidarPoint& p) { return to(p, x, y) < 0.1F; }))
        << x << " " << y;
  }
  EXPECT_GT(features.smooth.size(), 100U);
  for (const scan::LidarPoint& p : features.planes) {
    const float wall = std::min(std::abs(std::max(std::abs(p.position.x()), std::abs(p.position.y())) - 5),
                                std::abs(p.position.x() - 2));
    EXPECT_LT(wall, 1e-3F);
  }
}

TEST(RingFeatures, WhatIsHalfHiddenIsNoFeature) {
  const RingFeatures features = ring_features(room(), Eigen::Vector3f::Zero(), config::LoamConfig{});
  // The pillar's sides are where it ends, wherever the lidar stands behind it: the wall beyond ends in its shadow.
  const float shadow = 5 * 0.5F / 2;
  for (const auto* kind : {&features.edges, &features.planes, &features.smooth}) {
    for (const scan::LidarPoint& p : *kind) {
      if (p.position.x() < 4.9F) continue;
      EXPECT_GT(std::abs(std::abs(p.position.y()) - shadow), 0.1F);
    }
  }
  EXPECT_TRUE(std::any_of(features.edges.begin(), features.edges.end(),
                          [&](const scan::LidarPoint& p) { return to(p, 2, 0.5F) < 0.1F; }));
}

TEST(RingFeatures, ChoosesEvenlyAndInNoMoreThanAsked) {
  config::LoamConfig config;
  config.sectors = 4;
  config.edges_per_sector = 1;
  config.planes_per_sector = 10;
  const RingFeatures features = ring_features(room(), Eigen::Vector3f::Zero(), config);
  EXPECT_LE(features.edges.size(), 4U);
  EXPECT_LE(features.planes.size(), 40U);
  for (const float sign : {-1.0F, 1.0F}) {
    EXPECT_GT(std::count_if(features.planes.begin(), features.planes.end(),
                            [&](const scan::LidarPoint& p) { return sign * p.position.y() > 0; }),
              4);
  }
}

TEST(RingFeatures, TheOrderOfTheRingsDoesNotMatterNorDoesEmptiness) {
  EXPECT_TRUE(ring_features({}, Eigen::Vector3f::Zero(), config::LoamConfig{}).edges.empty());
  std::vector<scan::LidarPoint> points = room();
  const RingFeatures before = ring_features(points, Eigen::Vector3f::Zero(), config::LoamConfig{});
  std::reverse(points.begin(), points.end());
  const RingFeatures after = ring_features(points, Eigen::Vector3f::Zero(), config::LoamConfig{});
  ASSERT_EQ(before.edges.size(), after.edges.size());
  for (std::size_t i = 0; i < before.edges.size(); ++i) {
    EXPECT_EQ(before.edges[i].position, after.edges[i].position);
  }
}

}  // namespace
}  // namespace curbstone::mapper::registration
