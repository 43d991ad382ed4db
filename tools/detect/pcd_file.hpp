#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <vector>

namespace curbstone::detect {

/// Reads x y z of a PCD file: ascii, binary or compressed, float32 or float64. Relative to `origin`; VIEWPOINT is not
/// applied. Throws CloudFileError, with the line where it has one.
[[nodiscard]] std::vector<Eigen::Vector3f> read_pcd(const std::filesystem::path& path, const Eigen::Vector3d& origin);

}  // namespace curbstone::detect
