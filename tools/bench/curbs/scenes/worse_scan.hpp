#pragma once

#include <cstdint>
#include <vector>

#include "tools/simulate/recorded/scan_set.hpp"

namespace curbstone::bench::curbs::scenes {

/// By how much a sensor, or the weather, is worse than those that a scan was recorded with.
struct ScanLoss {
  double range_noise = 0;  ///< m, 1 sigma, added along each ray
  double kept = 1;         ///< 0..1 of the points, drawn at random
  int lasers = 1;          ///< one in so many
};

/// What is left of a scan that is stored laser by laser, each counter-clockwise from ahead, as KITTI's are.
[[nodiscard]] std::vector<simulate::recorded::ScanPoint> worsened(
    const std::vector<simulate::recorded::ScanPoint>& scan, const ScanLoss& loss, std::uint64_t seed);

}  // namespace curbstone::bench::curbs::scenes
