#include "drivers/lidar/decoding/direction.hpp"

#include <cmath>
#include <cstddef>
#include <vector>

#include "drivers/lidar/decoding/shot_table.hpp"

namespace curbstone::lidar::decoding {

namespace {

std::vector<Direction> all_directions() {
  std::vector<Direction> directions(36000);
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const double azimuth = 0.01 * static_cast<double>(i) * kDegree;
    directions[i] = {std::cos(azimuth), std::sin(azimuth)};
  }
  return directions;
}

}  // namespace

const Direction& direction_of(int azimuth) {
  static const std::vector<Direction> directions = all_directions();
  return directions[static_cast<std::size_t>(azimuth)];
}

}  // namespace curbstone::lidar::decoding
