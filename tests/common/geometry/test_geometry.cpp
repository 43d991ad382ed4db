#include "common/geometry/geometry.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "common/geometry/pose_covariance.hpp"

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

/// A pose with an error in its own axes: translation, then rotation.
Pose disturbed(const Pose& pose, const Eigen::Matrix<double, 6, 1>& error) {
  Pose out = pose;
  out.translation() += pose.linear() * error.head<3>();
  out.linear() = pose.linear() * so3_exp(error.tail<3>()).toRotationMatrix();
  return out;
}

TEST(PoseCovarianceTest, OfAnIncrementIsThatOfItsTwoEnds) {
  Pose T_map_begin = Pose::Identity(), T_begin_end = Pose::Identity();
  T_map_begin.translation() << 5, -3, 1;
  T_map_begin.linear() = rotation_from_rpy(0.1, -0.2, 2.0);
  T_begin_end.translation() << 2, 0.5, -0.1;
  T_begin_end.linear() = rotation_from_rpy(0.05, 0.02, 0.6);
  const Pose T_map_end = T_map_begin * T_begin_end;
  Eigen::Matrix<double, 6, 12> J;  // of the increment's error, in the axes at the end, by the errors of the two poses
  for (int i = 0; i < 12; ++i) {
    const auto error_by = [&](double size) {
      Eigen::Matrix<double, 6, 1> begin, end;
      begin.setZero();
      end.setZero();
      (i < 6 ? begin : end)(i % 6) = size;
      const Pose seen = disturbed(T_map_begin, begin).inverse() * disturbed(T_map_end, end);
      const Eigen::Matrix3d R = T_begin_end.linear().transpose();
      Eigen::Matrix<double, 6, 1> error;
      error << R * (seen.translation() - T_begin_end.translation()), so3_log(Eigen::Quaterniond(R * seen.linear()));
      return error;
    };
    constexpr double kDelta = 1e-5;
    J.col(i) = (error_by(kDelta) - error_by(-kDelta)) / (2 * kDelta);
  }
  const PoseCovariance A = PoseCovariance::Random(), B = PoseCovariance::Random();
  const PoseCovariance begin = A * A.transpose(), end = B * B.transpose();
  const PoseCovariance expected =
      J.leftCols<6>() * begin * J.leftCols<6>().transpose() + J.rightCols<6>() * end * J.rightCols<6>().transpose();
  EXPECT_LT((covariance_of_increment(T_begin_end, begin, end) - expected).cwiseAbs().maxCoeff(), 1e-7);
}

}  // namespace
}  // namespace curbstone
