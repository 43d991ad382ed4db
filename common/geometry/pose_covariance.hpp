#pragma once

#include <Eigen/Core>

#include "common/geometry/geometry.hpp"

namespace curbstone {

/// The covariance of a pose's error: rows 0..2 translation, 3..5 rotation vector, in the axes of the body frame whose
/// pose it is. m^2, m rad, rad^2.
using PoseCovariance = Eigen::Matrix<double, 6, 6>;

/// The covariance of a frame's motion from one pose to another, in its axes at the end. The errors of the two poses
/// must be independent. The adjoint of the inverse motion carries the error at the beginning to the end (Barfoot, State
/// Estimation for Robotics, chapter 7).
[[nodiscard]] inline PoseCovariance covariance_of_increment(const Pose& T_begin_end, const PoseCovariance& begin,
                                                            const PoseCovariance& end) {
  const Eigen::Matrix3d R = T_begin_end.linear().transpose();
  PoseCovariance carry = PoseCovariance::Zero();
  carry.topLeftCorner<3, 3>() = carry.bottomRightCorner<3, 3>() = R;
  carry.topRightCorner<3, 3>() = -R * skew(T_begin_end.translation());
  return carry * begin * carry.transpose() + end;
}

}  // namespace curbstone
