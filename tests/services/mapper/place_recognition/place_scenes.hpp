#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "services/mapper/scan/keyframe.hpp"
#include "services/mapper/scan/scan.hpp"
#include "tools/simulate/numerics/random.hpp"

/// What bench_places asks about.
namespace curbstone::test {

struct View {
  Pose T_map_base;
  std::vector<mapper::scan::LidarPoint> points;
};

/// A drive's nodes, scans taken near them, and scans taken out of their sight.
struct Places {
  std::string name;
  Eigen::Vector3d lidar;
  std::vector<mapper::scan::Keyframe> nodes;
  std::vector<View> near, far;
};

/// What happened since the nodes were made.
struct Changes {
  int cars = 0;
  double drift = 0;
  bool half = false;
};

/// Nodes along 190 m, `spacing` m apart; scans from either lane, in either direction, minutes later.
Places town(std::uint64_t seed, double spacing);
/// The recorded street. Every third scan or so of the first 30 m is a node; the others are near, those from 45 m on
/// far.
Places street(const std::string& folder, double spacing);
void change(Places& places, const Changes& changes, simulate::numerics::Random random);

}  // namespace curbstone::test
