#pragma once

#include <curbstone/map_pose_t.hpp>
#include <string>
#include <vector>

namespace curbstone::localise {

/// Draws a drive on the map in which it was localised: both paths, where it was lost, and the uncertainty of the pose.
/// Throws PictureError and MapStoreError.
void draw_drive(const std::string& map, const std::vector<map_pose_t>& poses, const std::string& png);

}  // namespace curbstone::localise
