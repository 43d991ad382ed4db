#include "services/localizer/tracking/prediction.hpp"

#include <algorithm>
#include <cmath>

namespace curbstone::localizer::tracking {
namespace {

constexpr double kBlindSpeed = 1.0;  // m/s, 1 sigma, by which a vehicle may differ from its steady motion
constexpr double kBlindTurn = 0.3;   // rad/s
constexpr double kMaxSigma = 2.0;    // m: of a lost vehicle; with a larger one a fit would match another wall
constexpr double kMaxYaw = 0.2;      // rad

}  // namespace

Matrix6 motion_jacobian(const Pose& T_map_base, const Motion& motion) {
  Matrix6 F = Matrix6::Identity();
  F.topRightCorner<3, 3>() = -T_map_base.linear() * skew(motion.T_last_base.translation());
  F.bottomRightCorner<3, 3>() = motion.T_last_base.linear().transpose();
  return F;
}

PoseBelief predicted(const PoseBelief& belief, const Motion& motion, const TrackingConfig& config) {
  const Matrix6 F = motion_jacobian(belief.T_map_base, motion);
  PoseBelief next;
  next.covariance = F * belief.covariance * F.transpose();
  next.T_map_base = normalised(belief.T_map_base * motion.T_last_base);

  double position = config.odometry_floor_m + config.odometry_m * motion.T_last_base.translation().norm();
  double rotation = config.odometry_floor_rad + config.odometry_rad * angle_of(motion.T_last_base);
  if (!motion.with_odometry) {
    position += kBlindSpeed * std::min(motion.seconds, 10.0);
    rotation += kBlindTurn * std::min(motion.seconds, 10.0);
  }
  next.covariance.diagonal().head<3>().array() += position * position;
  next.covariance.diagonal().tail<3>().array() += rotation * rotation;
  // Bounds the range that a lost vehicle searches. Beyond it a Gaussian is not a valid approximation either.
  const double widest = std::sqrt(next.covariance.diagonal().head<3>().maxCoeff()) / kMaxSigma;
  const double most_turned = std::sqrt(next.covariance.diagonal().tail<3>().maxCoeff()) / kMaxYaw;
  const double excess = std::max(widest, most_turned);
  if (excess > 1) next.covariance /= excess * excess;
  return next;
}

}  // namespace curbstone::localizer::tracking
