#pragma once

#include <cmath>
#include <cstdint>
#include <string>

#include "services/mapper/config/mapper_config.hpp"
#include "tests/services/mapper/synthetic_world.hpp"

namespace curbstone::test {

inline constexpr double kRadius = 26;  // m: once around is more than the least loop
inline constexpr double kSpeed = 12;   // m/s

inline Pose around(double t) {
  const double angle = kSpeed / kRadius * t;
  return pose(kRadius * std::cos(angle), kRadius * std::sin(angle), 0, 0, 0, angle + M_PI / 2);
}

/// Boxes of many sizes within and without the round street: no place looks like another.
inline SyntheticWorld round_street() {
  SyntheticWorld world;
  world.noise = 0.01;
  std::uint32_t state = 7;
  const auto random = [&](double low, double high) {
    state = state * 1664525U + 1013904223U;
    return low + (high - low) * (state >> 8) / 16777216.0;
  };
  for (const double side : {-1.0, 1.0}) {
    for (double angle = 0; angle < 2 * M_PI; angle += random(0.12, 0.3)) {
      const double r = kRadius + side * random(5, 8);
      const Eigen::Vector3d place(r * std::cos(angle), r * std::sin(angle), 0);
      const double width = random(0.3, 1.5);
      const double depth = random(0.3, 1.5);
      world.boxes.push_back(
          {place - Eigen::Vector3d(width, depth, 0), place + Eigen::Vector3d(width, depth, random(1, 5))});
    }
  }
  return world;
}

/// A mapper that is back at an unknown place after one round, and moves the map for any correction.
inline void forget_soon(mapper::config::MapperConfig& config) {
  config.registration.icp.window = 25;
  config.registration.icp.max_range = 25;
  config.loop.rearrange_m = 0;
}

/// A mapper that has little of its map in memory: the rest is in a file in `far_folder`, or packed if that is empty.
inline void keep_little_in_memory(mapper::config::MapperConfig& config, const std::string& far_folder) {
  config.dense.max_range = 8;
  config.dense.awake = 2;
  config.dense.asleep_here = 3;
  config.far_folder = far_folder;
  config.keep_free = 0;
}

}  // namespace curbstone::test
