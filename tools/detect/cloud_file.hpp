#pragma once

#include <Eigen/Core>
#include <stdexcept>
#include <string>
#include <vector>

#include "tools/detect/cloud_map/cloud_map.hpp"

namespace curbstone::detect {

/// One clear line that names the file and what is wrong with it.
class CloudFileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Reads a cloud by the name's ending: .pcd and .ply (PCL), .bin (KITTI: float32 x y z intensity). What comes out is
/// relative to `origin`, in the file's frame: the coordinates of a georeferenced cloud (float64) are too large for
/// float32. Points that are not finite are kept (and counted by map_cloud). Throws CloudFileError: missing, truncated,
/// no cloud, empty.
[[nodiscard]] std::vector<Eigen::Vector3f> read_cloud(const std::string& path,
                                                      const Eigen::Vector3d& origin = Eigen::Vector3d::Zero());

/// Reads all scans (*.bin, *.pcd, *.ply, by name: 2.bin stands before 10.bin) of a folder into the frame of their
/// poses, relative to `origin` in it: `poses` has a row a scan, 3x4, scan to map. Returns nearer than `min_range` m to
/// their sensor are left out. Throws CloudFileError.
[[nodiscard]] std::vector<Eigen::Vector3f> read_cloud_folder(const std::string& folder, const std::string& poses,
                                                             double min_range = 0,
                                                             const Eigen::Vector3d& origin = Eigen::Vector3d::Zero());

/// Binary .pcd: x y z normal_x normal_y normal_z stick plate ball (float32), label (uint32, semantic_tile_t's classes).
void write_labelled_pcd(const std::vector<cloud_map::DetectedPoint>& points, const std::string& path);

}  // namespace curbstone::detect
