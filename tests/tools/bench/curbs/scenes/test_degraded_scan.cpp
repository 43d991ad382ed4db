#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tools/bench/curbs/scenes/degraded_scan.hpp"

namespace curbstone::bench::curbs::scenes {
namespace {

constexpr int kLasers = 8;
constexpr int kColumns = 500;
constexpr float kRange = 10;

/// What stands around at 10 m; the intensity says which laser saw it.
std::vector<simulate::recorded::ScanPoint> round_scan() {
  std::vector<simulate::recorded::ScanPoint> scan;
  for (int laser = 0; laser < kLasers; ++laser) {
    for (int column = 0; column < kColumns; ++column) {
      const auto azimuth = static_cast<float>(2 * std::numbers::pi * (column + 0.5) / kColumns);
      scan.push_back({{kRange * std::cos(azimuth), kRange * std::sin(azimuth), 0}, static_cast<std::uint8_t>(laser)});
    }
  }
  return scan;
}

TEST(WorseScan, IsTheSameWhereNothingIsLost) {
  const std::vector<simulate::recorded::ScanPoint> scan = round_scan();
  const std::vector<simulate::recorded::ScanPoint> left = worsened(scan, {}, 1);
  ASSERT_EQ(left.size(), scan.size());
  for (std::size_t i = 0; i < scan.size(); ++i) EXPECT_EQ(left[i].position, scan[i].position);
}

TEST(WorseScan, HasOneLaserInSoMany) {
  const std::vector<simulate::recorded::ScanPoint> left = worsened(round_scan(), {.lasers = 3}, 1);
  EXPECT_EQ(left.size(), 3U * kColumns);
  for (const simulate::recorded::ScanPoint& point : left) EXPECT_EQ(point.intensity % 3, 0);
}

TEST(WorseScan, KeepsAShareOfThePoints) {
  const std::vector<simulate::recorded::ScanPoint> left = worsened(round_scan(), {.kept = 0.25}, 1);
  EXPECT_NEAR(static_cast<double>(left.size()), 0.25 * kLasers * kColumns, 100);
}

TEST(WorseScan, IsOffAlongTheRaysByItsNoise) {
  const std::vector<simulate::recorded::ScanPoint> scan = round_scan();
  const std::vector<simulate::recorded::ScanPoint> left = worsened(scan, {.range_noise = 0.1}, 1);
  ASSERT_EQ(left.size(), scan.size());
  double square = 0;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const Eigen::Vector3f off = left[i].position - scan[i].position;
    EXPECT_LT(off.cross(scan[i].position.normalized()).norm(), 1e-5F);
    square += static_cast<double>(off.squaredNorm());
  }
  EXPECT_NEAR(std::sqrt(square / static_cast<double>(scan.size())), 0.1, 0.005);
}

}  // namespace
}  // namespace curbstone::bench::curbs::scenes
