#pragma once

#include <cstddef>
#include <filesystem>
#include <string_view>
#include <vector>

#include "common/geometry/geometry.hpp"

namespace curbstone::mapper::storage {

/// Binary PCD 0.7 (pointclouds.org, "The PCD file format") with float32 fields only, for maps; PCL, pcl_viewer and
/// CloudCompare open it. Implemented here and not with PCL, which trusts the sizes that a file claims.
///
/// Writes a file. `fields` as in the file: "x y z intensity". `values`: point after point. Throws MapFolderError.
void write_pcd(const std::filesystem::path& path, std::string_view fields, const std::vector<float>& values,
               const Pose& viewpoint = Pose::Identity());

/// Reads a file. Throws MapFolderError, also if the file has other fields or more than `max_points`.
[[nodiscard]] std::vector<float> read_pcd(const std::filesystem::path& path, std::string_view fields,
                                          std::size_t max_points);

}  // namespace curbstone::mapper::storage
