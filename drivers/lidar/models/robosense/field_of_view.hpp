#pragma once

namespace curbstone::lidar::models::robosense {

/// deg, of a device that fires from one azimuth to another, 0.01 deg; from an azimuth to itself: all around.
[[nodiscard]] constexpr double field_of_view(int start, int end) {
  const int fires = ((end - start) % 36000 + 36000) % 36000;
  return fires == 0 ? 360.0 : fires * 0.01;
}

}  // namespace curbstone::lidar::models::robosense
