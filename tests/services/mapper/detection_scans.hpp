#pragma once

#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

#include "services/mapper/scan/scan_assembler.hpp"
#include "tests/services/mapper/mapper_drive.hpp"

namespace curbstone::test {

/// Revolutions of a vehicle in a street, one after the other, in lidar.
struct DetectionScans {
  SyntheticWorld world = street();
  SyntheticWorld::Trajectory trajectory = [](double) { return pose(0, 0, 0, 0, 0, 0); };
  Pose T_base_lidar = default_lidar();
  int turn = 0;

  DetectionScans() { world.noise = 0.01; }
  mapper::scan::Scan next() {
    const int n = turn++;
    return scan_of(world.packets(trajectory, T_base_lidar, n, n * kPeriod, kPeriod));
  }
};

/// The laser's points higher by `degrees`, as if the driver took its elevation for that much more.
inline void raise(mapper::scan::Scan& scan, int ring, double degrees) {
  for (mapper::scan::LidarPoint& point : scan.points) {
    if (point.ring != ring) continue;
    Eigen::Vector3f& p = point.position;
    const float level = p.head<2>().norm();
    const float range = p.norm();
    const float elevation = std::atan2(p.z(), level) + static_cast<float>(degrees * 3.14159265358979 / 180);
    p.head<2>() *= range * std::cos(elevation) / level;
    p.z() = range * std::sin(elevation);
  }
}

/// 0..1, of the place in a stream alone.
inline double chance(std::uint64_t n) {
  n = (n + 1) * 0x9e3779b97f4a7c15ULL;
  n = (n ^ (n >> 30)) * 0xbf58476d1ce4e5b9ULL;
  n = (n ^ (n >> 27)) * 0x94d049bb133111ebULL;
  return static_cast<double>((n ^ (n >> 31)) >> 11) / 9007199254740992.0;
}

}  // namespace curbstone::test
