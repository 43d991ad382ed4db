#include "tools/simulate/recorded/laser_scale.hpp"

#include <algorithm>
#include <cmath>

namespace curbstone::simulate::recorded {

namespace {

constexpr std::size_t kMaxScans = 40;

/// As mapper::intensity::RingScale, in the lidar's frame.
bool is_on_the_road(const Eigen::Vector3f& p, double height) {
  const float along = std::abs(p.x());
  return std::abs(p.y()) < 1.2F && along > 3.0F && along < 25.0F &&
         std::abs(p.z() + static_cast<float>(height)) < 0.10F + 0.03F * along;
}

mapper::intensity::RingHistograms road_of(const ScanSet& scans, double height) {
  mapper::intensity::RingHistograms road;
  const std::size_t step = (scans.files.size() + kMaxScans - 1) / kMaxScans;
  for (std::size_t i = 0; i < scans.files.size(); i += step) {
    for (const ScanPoint& point : read_scan(scans.files[i])) {
      if (!is_on_the_road(point.position, height)) continue;
      if (point.laser >= road.rings.size()) road.rings.resize(std::size_t{point.laser} + 1);
      ++road.rings[point.laser][point.intensity];
    }
    ++road.scans;
  }
  return road;
}

}  // namespace

LaserScale::LaserScale(const ScanSet& scans, double height) : table_(road_of(scans, height)) {}

}  // namespace curbstone::simulate::recorded
