#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::returns {

constexpr int kNumDirections = 720;        ///< directions about the LiDAR, half a degree each
constexpr double kDirectionDegrees = 0.5;  ///< deg
constexpr std::size_t kMaxLasers = 128;    ///< rings above are left out

/// What one laser saw in a revolution.
struct LaserDistances {
  std::array<float, kNumDirections> level{};  ///< m, of the first return in each direction, in the plane; 0: none
  float rise = 0;                             ///< of its beam, m up per m level, mean
  int returns = 0;                            ///< directions with one
};

/// By ring.
[[nodiscard]] std::vector<LaserDistances> level_distances(const scan::Scan& scan);

}  // namespace curbstone::mapper::returns
