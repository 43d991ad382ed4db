#include "tools/detect/cloud_check.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace curbstone::detect {
namespace {

/// Nine points in ten on the ground, 1.7 m below the sensor, the others up a wall of 8 m.
std::vector<Eigen::Vector3f> street(float up) {
  std::vector<Eigen::Vector3f> cloud;
  for (int i = 0; i < 1000; ++i) {
    const auto along = static_cast<float>(i) * 0.02F;
    cloud.emplace_back(along, 3, up * (i % 10 == 0 ? along / 20 * 8 : -1.7F));
  }
  return cloud;
}

TEST(CloudCheckTest, AStreetIsUprightAndTurnedOverItIsNot) {
  EXPECT_FALSE(seems_upside_down(street(1)));
  EXPECT_TRUE(seems_upside_down(street(-1)));
}

TEST(CloudCheckTest, WhatIsFlatHasNoUpAndDown) {
  std::vector<Eigen::Vector3f> flat = street(-1);
  for (Eigen::Vector3f& p : flat) p.z() *= 0.1F;
  EXPECT_FALSE(seems_upside_down(flat));
}

TEST(CloudCheckTest, TheMiddleIsThatOfTheFinitePoints) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Eigen::Vector3f> cloud = {{1, 10, 100}, {2, 20, 200}, {nan, 0, 0}, {900, 30, 300}};
  ASSERT_TRUE(middle_of(cloud));
  EXPECT_EQ(*middle_of(cloud), Eigen::Vector3d(2, 20, 200));
}

TEST(CloudCheckTest, NothingFiniteHasNoMiddleAndNoUp) {
  const std::vector<Eigen::Vector3f> nothing(3, Eigen::Vector3f::Constant(std::nanf("")));
  EXPECT_FALSE(middle_of(nothing));
  EXPECT_FALSE(seems_upside_down(nothing));
  EXPECT_FALSE(middle_of({}));
  EXPECT_FALSE(seems_upside_down({}));
}

}  // namespace
}  // namespace curbstone::detect
