#pragma once

#include <string>
#include <vector>

#include "services/semantic_map/picture/canvas.hpp"
#include "tools/detect/cloud_map/cloud_map.hpp"

namespace curbstone::detect {

/// A picture of the result of one step of the method on a cloud.
struct StepPicture {
  std::string name;  ///< for example "3_road_height"
  semantic_map::picture::Canvas canvas;
};

/// Draws the method step by step, as the paper's Fig. 8-12: stick share, direction of the normal, road height at 0.5 m,
/// DEM, tilt against the ground, curb evidence, filtered evidence. Seen from above, x to the right, 5 cm or more per
/// pixel. Tiles farther than `range` m from the origin are left out (0: none).
[[nodiscard]] std::vector<StepPicture> draw_method_steps(const std::vector<semantic_map::tile::VotedTile>& tiles,
                                                         const cloud_map::CloudMapOptions& options, double range);

}  // namespace curbstone::detect
