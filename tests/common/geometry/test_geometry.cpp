#include "common/geometry/geometry.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace curbstone {
namespace {

TEST(Geometry, LogInvertsExp) {
  for (const double angle : {0.0, 1e-12, 1e-7, 1e-3, 1.0, 3.0, std::numbers::pi - 1e-9}) {
    const Eigen::Vector3d v = angle * Eigen::Vector3d(1, -2, 0.5).normalized();
    EXPECT_NEAR((so3_log(so3_exp(v)) - v).norm(), 0, 1e-9) << angle;
  }
}

TEST(Geometry, RollPitchYawRoundTrips) {
  const Eigen::Vector3d rpy(0.1, -0.2, 2.5);
  EXPECT_NEAR((roll_pitch_yaw(rotation_from_rpy(0.1, -0.2, 2.5)) - rpy).norm(), 0, 1e-12);
}

TEST(Geometry, InterpolationMeetsItsEndsAndGoesOn) {
  Pose a = Pose::Identity();
  Pose b = Pose::Identity();
  b.translation().x() = 2;
  b.linear() = rotation_from_rpy(0, 0, 1);
  EXPECT_TRUE(interpolate(a, b, 0).isApprox(a));
  EXPECT_TRUE(interpolate(a, b, 1).isApprox(b, 1e-12));
  EXPECT_NEAR(roll_pitch_yaw(interpolate(a, b, 0.25).linear()).z(), 0.25, 1e-12);
}

TEST(Geometry, BadQuaternionsMakeAnInvalidPose) {
  const double position[3] = {1, 2, 3};
  const double zero[4] = {0, 0, 0, 0};
  const double good[4] = {1, 0, 0, 0};
  EXPECT_FALSE(is_finite(pose_from_arrays(position, zero)));
  EXPECT_TRUE(is_finite(pose_from_arrays(position, good)));
}

}  // namespace
}  // namespace curbstone
