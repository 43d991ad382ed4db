#include "services/mapper/mounting/azimuth_profile.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/services/mapper/detection_scans.hpp"

namespace curbstone::mapper::mounting {
namespace {

using test::kDegree;

/// Trees about the vehicle: each laser's returns lie somewhere in their crowns, and no two scans see the same.
std::vector<scan::LidarPoint> trees(double yaw, std::uint64_t seed, int rings = 16) {
  std::vector<scan::LidarPoint> points;
  for (int ring = 0; ring < rings; ++ring) {
    for (int i = 0; i < 900; ++i) {
      const double azimuth = (i + test::chance(seed * 77 + static_cast<std::uint64_t>(ring))) * 0.4 * kDegree;
      const int tree = i / 30;
      if (tree % 2 == 1) continue;  // a gap
      const double range = 6 + tree + test::chance(seed * 100'000 + static_cast<std::uint64_t>(ring * 900 + i));
      scan::LidarPoint point;
      point.position =
          Eigen::Vector3d(range * std::cos(azimuth + yaw), range * std::sin(azimuth + yaw), 3).cast<float>();
      point.ring = static_cast<std::uint8_t>(ring);
      points.push_back(point);
    }
  }
  return points;
}

AzimuthProfile profile(double yaw, std::uint64_t seed, int rings = 16) {
  return {trees(yaw, seed, rings), Pose::Identity(), Eigen::Vector3d::Zero()};
}

TEST(AzimuthProfile, GivesTheTurnBetweenTwoScansThatSeeTrees) {
  for (const double degrees : {-20.0, -3.0, -1.2, 0.0, 0.7, 5.0, 14.0}) {
    const auto turn = profile(degrees * kDegree, 1).turn_since(profile(0, 2));
    ASSERT_TRUE(turn);
    EXPECT_NEAR(turn->angle, degrees * kDegree, 0.25 * kDegree) << degrees;
    if (std::abs(degrees) > 1) {
      EXPECT_LT(turn->residual, 0.9 * turn->residual_at_zero) << degrees;
    }
  }
}

TEST(AzimuthProfile, IsSeenFromWhereTheVehicleWas) {
  const Eigen::Vector3d lidar(0.5, 0, 1.8);
  const Pose T_there_base = test::pose(0.4, 0.1, 0, 0, 0, 0.2);
  std::vector<scan::LidarPoint> moved = trees(0, 1);
  for (scan::LidarPoint& point : moved)
    point.position = (T_there_base.inverse() * point.position.cast<double>()).cast<float>();
  const auto turn = AzimuthProfile(moved, T_there_base, lidar).turn_since({trees(0, 2), Pose::Identity(), lidar});
  ASSERT_TRUE(turn);
  EXPECT_NEAR(turn->angle, 0, 0.1 * kDegree);
}

TEST(AzimuthProfile, TooFewRangesGiveNothing) {
  EXPECT_FALSE(profile(0, 1, 0).turn_since(profile(0, 2)));
  EXPECT_FALSE(profile(0, 1).turn_since(profile(0, 2, 0)));
}

TEST(AzimuthProfile, TheGroundIsLeftOut) {
  std::vector<scan::LidarPoint> ground = trees(0, 1);
  for (scan::LidarPoint& point : ground) point.position.z() = 0.1F;
  EXPECT_EQ(AzimuthProfile(ground, Pose::Identity(), Eigen::Vector3d::Zero()).size(), 0U);
}

TEST(AzimuthProfile, PointsThatAreNotFiniteAreLeftOut) {
  std::vector<scan::LidarPoint> points = trees(0, 1);
  const std::size_t all = AzimuthProfile(points, Pose::Identity(), Eigen::Vector3d::Zero()).size();
  for (scan::LidarPoint& point : points) {
    if (point.ring == 3) point.position.x() = std::numeric_limits<float>::quiet_NaN();
  }
  EXPECT_NEAR(static_cast<double>(AzimuthProfile(points, Pose::Identity(), Eigen::Vector3d::Zero()).size()),
              static_cast<double>(all) * 15 / 16, 5);
}

}  // namespace
}  // namespace curbstone::mapper::mounting
