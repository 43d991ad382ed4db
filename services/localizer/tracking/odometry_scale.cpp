#include "services/localizer/tracking/odometry_scale.hpp"

#include <algorithm>
#include <cmath>

#include "common/linear/decompositions.hpp"
#include "services/localizer/tracking/prediction.hpp"

namespace curbstone::localizer::tracking {
namespace {

constexpr double kWalk = 0.0005;          // 1 sigma by which the scale changes within a metre, growing with its root
constexpr double kMost = 0.05;            // of the scale, either way: more are wheels that slip
constexpr double kLeast = 1e-6;           // 1 sigma of the scale, at least: rounding must not make it certain
constexpr double kMostCorrelated = 0.99;  // of pose and scale: bounds the rounding of a covariance

}  // namespace

double OdometryScale::sigma() const {
  return std::sqrt(variance_);
}

Motion OdometryScale::corrected(const Motion& motion) const {
  Motion corrected = motion;
  if (motion.with_odometry) corrected.T_last_base.translation() *= 1 + value_;
  return corrected;
}

PoseBelief OdometryScale::predict(const PoseBelief& before, const Motion& motion, PoseBelief predicted) {
  const Eigen::Vector3d way = motion.T_last_base.translation();
  variance_ = std::min(variance_ + kWalk * kWalk * way.norm(), kSigma * kSigma);
  const Vector6 carried = motion_jacobian(before.T_map_base, motion) * with_pose_;
  Vector6 by_scale = Vector6::Zero();
  if (motion.with_odometry) by_scale.head<3>() = before.T_map_base.linear() * way;
  predicted.covariance +=
      variance_ * by_scale * by_scale.transpose() + carried * by_scale.transpose() + by_scale * carried.transpose();
  with_pose_ = carried + variance_ * by_scale;
  // A lost pose's covariance is bounded, which the correlation has to follow.
  const double shared = with_pose_.dot(inverse(predicted.covariance) * with_pose_);
  if (!std::isfinite(shared))
    forget_pose();
  else if (shared > kMostCorrelated * variance_)
    with_pose_ *= std::sqrt(kMostCorrelated * variance_ / shared);
  return predicted;
}

void OdometryScale::update(const PoseBelief& predicted, const PoseBelief& corrected) {
  const Vector6 gain = inverse(predicted.covariance) * with_pose_;
  if (!gain.allFinite()) return forget_pose();  // the covariance is singular
  value_ += gain.dot(error_between(predicted.T_map_base, corrected.T_map_base));
  value_ = std::clamp(value_, -kMost, kMost);
  variance_ = std::max(variance_ - gain.dot((predicted.covariance - corrected.covariance) * gain), kLeast * kLeast);
  with_pose_ = corrected.covariance * gain;
}

}  // namespace curbstone::localizer::tracking
