#pragma once

#include <cstdint>
#include <vector>

#include "tools/simulate/recorded/scan_set.hpp"

namespace curbstone::bench::curbs::scenes {

/// How much a sensor or the weather is worse than in the recording.
struct ScanLoss {
  double range_noise = 0;  ///< m, 1 sigma, added along each ray
  double kept = 1;         ///< 0..1, share of the points kept, at random
  int lasers = 1;          ///< one laser in `lasers` is kept
};

/// Degrades a scan that is stored laser by laser, each counter-clockwise from ahead, as in KITTI.
[[nodiscard]] std::vector<simulate::recorded::ScanPoint> worsened(
    const std::vector<simulate::recorded::ScanPoint>& scan, const ScanLoss& loss, std::uint64_t seed);

}  // namespace curbstone::bench::curbs::scenes
