#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "tools/detect/cloud_file_error.hpp"
#include "tools/detect/cloud_map/cloud_map.hpp"

namespace curbstone::detect {

/// Reads a cloud; the file name's extension gives the format: .pcd, .ply, .bin (KITTI: float32 x y z intensity). The
/// points are relative to `origin`, in the file's frame, because the coordinates of a georeferenced cloud (float64) are
/// too large for float32. Non-finite points are kept (map_cloud() counts them). Throws CloudFileError: missing,
/// truncated, not a cloud, empty.
[[nodiscard]] std::vector<Eigen::Vector3f> read_cloud(const std::string& path,
                                                      const Eigen::Vector3d& origin = Eigen::Vector3d::Zero());

/// Reads all scans (*.bin, *.pcd, *.ply, by name: 2.bin before 10.bin) of a folder into the frame of their poses,
/// relative to `origin` in that frame. `poses` has one row per scan, 3x4, scan to map. Returns nearer than `min_range`
/// m to their sensor are left out. Throws CloudFileError.
[[nodiscard]] std::vector<Eigen::Vector3f> read_cloud_folder(const std::string& folder, const std::string& poses,
                                                             double min_range = 0,
                                                             const Eigen::Vector3d& origin = Eigen::Vector3d::Zero());

/// Writes a binary .pcd: x y z normal_x normal_y normal_z stick plate ball (float32), label (uint32, semantic_tile_t's
/// classes).
void write_labelled_pcd(const std::vector<cloud_map::DetectedPoint>& points, const std::string& path);

}  // namespace curbstone::detect
