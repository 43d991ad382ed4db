#include "services/mapper/mounting/turn_by_scans.hpp"

#include <utility>

namespace curbstone::mapper::mounting {
namespace {

constexpr double kOtherPlace = 0.7;  // residual beyond which the two scans show different things

}  // namespace

void TurnByScans::start_from(std::int64_t utime, const std::vector<scan::LidarPoint>& points, const Pose& T_odom_base) {
  reference_.emplace(Reference{utime, T_odom_base, {points, Pose::Identity(), lidar_}});
  error_ = 0;
}

double TurnByScans::error_since_last(std::int64_t utime, const std::vector<scan::LidarPoint>& points,
                                     const Pose& T_odom_base) {
  if (!reference_ || utime <= reference_->utime || utime - reference_->utime > 2 * kMaxAge) {
    start_from(utime, points, T_odom_base);
    return 0;
  }
  const Pose T_reference_base = reference_->T_odom_base.inverse() * T_odom_base;
  const AzimuthProfile here(points, T_reference_base, lidar_);
  const auto turn = here.turn_since(reference_->profile);
  double since_last = 0;
  if (turn && turn->residual < kOtherPlace) since_last = turn->angle - std::exchange(error_, turn->angle);
  const bool far = utime - reference_->utime >= kMaxAge || T_reference_base.translation().norm() > kMaxDistance;
  if (far || !turn) start_from(utime, points, T_odom_base);
  return since_last;
}

}  // namespace curbstone::mapper::mounting
