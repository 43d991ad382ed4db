#include "services/mapper/place_recognition/visibility_check.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace curbstone::mapper::place_recognition {
namespace {

constexpr int kAzimuths = 360, kElevations = 60;  // directions, a degree apart, +-30 deg
constexpr float kReach = 30.0F;                   // m
constexpr float kNear = 1.5F;                     // m: closer points are of the vehicle
constexpr float kSame = 0.6F;                     // m: points this close are of the same object

int direction_of(const Eigen::Vector3f& p) {
  constexpr float kDegree = std::numbers::pi_v<float> / 180;
  const int azimuth = static_cast<int>(std::floor(std::atan2(p.y(), p.x()) / kDegree)) + kAzimuths / 2;
  const int elevation = static_cast<int>(std::floor(std::atan2(p.z(), p.head<2>().norm()) / kDegree)) + kElevations / 2;
  if (elevation < 0 || elevation >= kElevations) return -1;
  return elevation * kAzimuths + std::clamp(azimuth, 0, kAzimuths - 1);
}

}  // namespace

VisibilityCheck::VisibilityCheck(const std::vector<Eigen::Vector3f>& points)
    : extents_(static_cast<std::size_t>(kAzimuths * kElevations), Extent{0, 0}) {
  for (const Eigen::Vector3f& p : points) {
    const float range = p.norm();
    if (!(range > kNear)) continue;
    const int direction = direction_of(p);
    if (direction < 0) continue;
    Extent& extent = extents_[static_cast<std::size_t>(direction)];
    extent.nearest = extent.farthest > 0 ? std::min(extent.nearest, range) : range;
    extent.farthest = std::max(extent.farthest, range);
  }
}

VisibilityCount VisibilityCheck::check(const std::vector<Eigen::Vector3f>& points) const {
  VisibilityCount count;
  for (const Eigen::Vector3f& p : points) {
    const float range = p.norm();
    if (!(range > kNear && range < kReach)) continue;
    const int direction = direction_of(p);
    if (direction < 0) continue;
    const Extent& extent = extents_[static_cast<std::size_t>(direction)];
    if (!(extent.farthest > 0) || range > extent.farthest + kSame) continue;
    if (range < extent.nearest - kSame) {
      ++count.conflict;
    } else {
      ++count.agree;
    }
  }
  return count;
}

}  // namespace curbstone::mapper::place_recognition
