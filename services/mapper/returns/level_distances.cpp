#include "services/mapper/returns/level_distances.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace curbstone::mapper::returns {

std::vector<LaserDistances> level_distances(const scan::Scan& scan) {
  std::vector<LaserDistances> lasers;
  for (const scan::LidarPoint& point : scan.points) {
    if (point.ring >= kMaxLasers) continue;
    if (point.ring >= lasers.size()) lasers.resize(point.ring + std::size_t{1});
    const float level = point.position.head<2>().norm();
    if (!point.position.allFinite() || !(level > 0)) continue;
    const float turn = std::atan2(point.position.y(), point.position.x()) / (2 * std::numbers::pi_v<float>);
    LaserDistances& laser = lasers[point.ring];
    float& first = laser.level[static_cast<std::size_t>(std::floor((turn + 1) * kNumDirections)) % kNumDirections];
    if (first > 0) continue;
    first = level;
    laser.rise += point.position.z() / level;
    ++laser.returns;
  }
  for (LaserDistances& laser : lasers) laser.rise /= static_cast<float>(std::max(laser.returns, 1));
  return lasers;
}

}  // namespace curbstone::mapper::returns
