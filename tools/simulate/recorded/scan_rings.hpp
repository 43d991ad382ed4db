#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace curbstone::simulate::recorded {

/// The laser of each point: from a file of rings (uint8 per point, 0 the top one) next to the scan if there is one,
/// else from the order of the points, laser by laser, as in KITTI; without such an order, by half a degree of
/// elevation. Numbers increase with the elevation.
[[nodiscard]] std::vector<std::uint8_t> rings_of(const std::vector<Eigen::Vector3f>& points,
                                                 const std::string& scan_file);

}  // namespace curbstone::simulate::recorded
