#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "common/geometry/geometry.hpp"

namespace curbstone::evaluate::truth {

/// A point that somebody said what it is of.
struct LabelledPoint {
  Eigen::Vector3d at;  ///< m
  std::uint16_t label =
      0;  ///< SemanticKITTI: 40 road, 44 parking, 48 sidewalk, 50 building, 70 vegetation, 72 terrain...
};

/// All points within `reach` m of the lidar of those scans of a folder that are labelled: scans/NNNNNN.bin,
/// labels/NNNNNN.label, reference_poses.txt. One scan alone needs no pose and may have any name. Moved by
/// `T_world_first` from the lidar frame of scan 0. Throws std::runtime_error with one clear line.
[[nodiscard]] std::vector<LabelledPoint> read_labelled_scans(const std::string& folder, const Pose& T_world_first,
                                                             double reach);

}  // namespace curbstone::evaluate::truth
