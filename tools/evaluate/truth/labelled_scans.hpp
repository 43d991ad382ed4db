#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "common/geometry/geometry.hpp"

namespace curbstone::evaluate::truth {

/// A point with a semantic label.
struct LabelledPoint {
  Eigen::Vector3d at;  ///< m
  std::uint16_t label =
      0;  ///< SemanticKITTI: 40 road, 44 parking, 48 sidewalk, 50 building, 70 vegetation, 72 terrain...
};

/// Reads all points within `reach` m of the lidar from the labelled scans of a folder: scans/NNNNNN.bin,
/// labels/NNNNNN.label, reference_poses.txt. A single scan needs no pose and may have any name. The points are
/// transformed by `T_world_first` from the lidar frame of scan 0. Throws std::runtime_error with a one-line message.
[[nodiscard]] std::vector<LabelledPoint> read_labelled_scans(const std::string& folder, const Pose& T_world_first,
                                                             double reach);

}  // namespace curbstone::evaluate::truth
