#include "services/mapper/scan/downsample.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>
#include <tuple>

namespace curbstone::mapper::scan {
namespace {

/// The first point of each voxel, by a set of cells.
std::vector<LidarPoint> first_of_each(const std::vector<LidarPoint>& points, double voxel, double max_range) {
  std::set<std::tuple<int, int, int>> taken;
  std::vector<LidarPoint> out;
  for (const LidarPoint& point : points) {
    if (point.position.norm() > static_cast<float>(max_range)) continue;
    const auto cell = [&](float v) { return static_cast<int>(std::floor(static_cast<double>(v) * (1 / voxel))); };
    const Eigen::Vector3f& p = point.position;
    if (taken.insert({cell(p.x()), cell(p.y()), cell(p.z())}).second) out.push_back(point);
  }
  return out;
}

void expect_first_of_each(double voxel, double max_range, float spread) {
  std::mt19937 random(1);
  std::normal_distribution<float> along(0, spread);
  std::vector<LidarPoint> points(20'000);
  for (LidarPoint& point : points) point.position = {along(random), along(random), along(random)};
  points[1].position = {-static_cast<float>(max_range), 0, 0};  // the ends of the lattice
  points[2].position = {0, 0, static_cast<float>(max_range)};
  const auto thinned = downsample(points, voxel, max_range), expected = first_of_each(points, voxel, max_range);
  ASSERT_EQ(thinned.size(), expected.size());
  EXPECT_LT(thinned.size(), points.size());
  for (std::size_t i = 0; i < thinned.size(); ++i) ASSERT_EQ(thinned[i].position, expected[i].position);
}

TEST(Downsample, KeepsTheFirstPointOfEachVoxel) {
  expect_first_of_each(0.25, 60, 2);
  expect_first_of_each(0.1, 60, 25);
}

TEST(Downsample, LikewiseInMoreVoxelsThanHaveANumberOf32Bits) {
  expect_first_of_each(0.02, 200, 0.2F);
  expect_first_of_each(0.02, 200, 60);
}

}  // namespace
}  // namespace curbstone::mapper::scan
