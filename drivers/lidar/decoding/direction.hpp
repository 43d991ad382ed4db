#pragma once

namespace curbstone::lidar::decoding {

struct Direction {
  double cos = 1;
  double sin = 0;
};

/// Cosine and sine of an azimuth in 0.01 deg, 0..35999: the library's values, from a table. The table has 576 kB and is
/// made at the first call.
[[nodiscard]] const Direction& direction_of(int azimuth);

}  // namespace curbstone::lidar::decoding
