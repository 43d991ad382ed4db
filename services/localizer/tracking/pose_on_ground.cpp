#include "services/localizer/tracking/pose_on_ground.hpp"

#include <cmath>

namespace curbstone::localizer::tracking {

Pose pose_on_ground(double x, double y, double yaw, const Eigen::Matrix3d& R_odom_base, fields::SavedMap& map) {
  const auto ground = map.ground_at(x, y);
  const double level = ground ? ground->height : map.level_at(x, y);
  const Eigen::Vector3d lean = roll_pitch_yaw(R_odom_base);
  Pose T_map_base = Pose::Identity();
  T_map_base.translation() = Eigen::Vector3d(x, y, std::isfinite(level) ? level : 0.0);
  T_map_base.linear() = rotation_from_rpy(lean.x(), lean.y(), yaw);
  return T_map_base;
}

}  // namespace curbstone::localizer::tracking
