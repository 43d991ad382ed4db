#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <vector>

namespace curbstone::detect {

/// Reads x y z of a PLY file's vertices: ascii, binary of either byte order, float32 or float64, whatever other
/// properties and elements it has. Relative to `origin`. Throws CloudFileError, with the line where it has one.
[[nodiscard]] std::vector<Eigen::Vector3f> read_ply(const std::filesystem::path& path, const Eigen::Vector3d& origin);

}  // namespace curbstone::detect
