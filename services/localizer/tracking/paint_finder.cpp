#include "services/localizer/tracking/paint_finder.hpp"

#include <cmath>

namespace curbstone::localizer::tracking {
namespace {

constexpr float kUneven = 0.3F;  // m above or below the vehicle's plane
constexpr float kSlope = 0.05F;  // and per metre of distance

}  // namespace

std::vector<Eigen::Vector3d> PaintFinder::find(const std::vector<mapper::scan::LidarPoint>& points,
                                               const Pose& T_odom_base) {
  scale_.learn(points, T_odom_base);
  std::vector<Eigen::Vector3d> bright;
  for (const mapper::scan::LidarPoint& point : points) {
    const Eigen::Vector3f& p = point.position;
    const float away = p.head<2>().cwiseAbs().maxCoeff();
    if (!(away < kReach) || !(std::abs(p.z()) < kUneven + kSlope * away)) continue;
    if (scale_.table()->of(point.ring, point.intensity) >= kBright) bright.push_back(p.cast<double>());
  }
  return bright;
}

}  // namespace curbstone::localizer::tracking
