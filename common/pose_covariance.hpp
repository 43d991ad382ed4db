#pragma once

#include <Eigen/Core>

#include "common/geometry.hpp"

namespace curbstone {

/// Of a pose's error: translation, rotation, in the axes of the frame that the pose places. m^2, m rad, rad^2.
using PoseCovariance = Eigen::Matrix<double, 6, 6>;

/// The covariance of how a frame moved, in its axes at the end, where the two poses' errors are independent: the error
/// of the pose at the beginning is carried to the end by the adjoint of the way back.
[[nodiscard]] inline PoseCovariance covariance_of_increment(const Pose& T_begin_end, const PoseCovariance& begin,
                                                            const PoseCovariance& end) {
  const Eigen::Matrix3d R = T_begin_end.linear().transpose();
  PoseCovariance carry = PoseCovariance::Zero();
  carry.topLeftCorner<3, 3>() = carry.bottomRightCorner<3, 3>() = R;
  carry.topRightCorner<3, 3>() = -R * skew(T_begin_end.translation());
  return carry * begin * carry.transpose() + end;
}

}  // namespace curbstone
