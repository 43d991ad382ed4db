#pragma once

#include <vector>

#include "tools/bench/sensor_faults/catalogue/fault.hpp"

namespace curbstone::bench::sensor_faults::catalogue {

/// A LiDAR that is loose on its mount or was knocked.
[[nodiscard]] std::vector<Fault> lidar_mount_faults();
/// Wrong stamps and numbers of its messages, and gaps.
[[nodiscard]] std::vector<Fault> lidar_stamp_faults();
/// Wrong ranges, lasers, intensities.
[[nodiscard]] std::vector<Fault> lidar_return_faults();
/// Points that are missing, or that nothing is at: weather, dirt, glass.
[[nodiscard]] std::vector<Fault> lidar_sight_faults();

/// Of the LiDAR, from a function of (t, lidar_points_t&), as for change().
template <class Function>
[[nodiscard]] Fault lidar_fault(std::string name, std::string words, double from, Function function) {
  return {"LiDAR", std::move(name), std::move(words), from,
          [function] { return Changes{.lidar = change<lidar_points_t>(function)}; }};
}

}  // namespace curbstone::bench::sensor_faults::catalogue
