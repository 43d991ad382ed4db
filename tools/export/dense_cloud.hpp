#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace curbstone::map_export {

/// A point of the mapper's dense map, m in map.
struct CloudPoint {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();
  float intensity = 0;  ///< 0..255
};

struct DenseCloud {
  std::vector<CloudPoint> points;  ///< by tile, then in the order of mapping
  std::int64_t missing = 0;        ///< implied by the point numbers, but not in the log
  std::int64_t refused = 0;        ///< messages that do not decode or are invalid
  bool log_is_damaged = false;     ///< parts of the log could not be read
};

/// Reads the points of one epoch from MAP_POINTS in an lcm-logger log (recorded live, or by `curbstone replay
/// --record`). Repeated points count once. Throws std::runtime_error: not a log, or no points of that epoch.
[[nodiscard]] DenseCloud read_dense_cloud(const std::string& log, std::int32_t epoch);

}  // namespace curbstone::map_export
