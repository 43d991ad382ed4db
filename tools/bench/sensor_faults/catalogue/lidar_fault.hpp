#pragma once

#include <string>
#include <utility>

#include "tools/bench/sensor_faults/catalogue/fault.hpp"

namespace curbstone::bench::sensor_faults::catalogue {

/// Of the LiDAR, from a function of (t, lidar_points_t&), as for change().
template <class Function>
[[nodiscard]] Fault lidar_fault(std::string name, std::string words, double from, Function function) {
  return {"LiDAR", std::move(name), std::move(words), from,
          [function] { return Changes{.lidar = change<lidar_points_t>(function)}; }};
}

}  // namespace curbstone::bench::sensor_faults::catalogue
