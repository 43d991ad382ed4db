#pragma once

#include <string>
#include <vector>

#include "services/semantic_map/picture/canvas.hpp"
#include "tools/detect/cloud_map/cloud_map.hpp"

namespace curbstone::detect {

/// A picture of what one step of the method has made of a cloud.
struct StepPicture {
  std::string name;  ///< as "3_road_height"
  semantic_map::picture::Canvas canvas;
};

/// The method step by step, as the paper's Fig. 8-12: stick share, direction of the normal, road height at 0.5 m, DEM,
/// tilt against the ground, curb evidence, what the filter leaves. From above, x to the right, 5 cm a pixel or more;
/// tiles farther than `range` m from the origin are left out (0: none are).
[[nodiscard]] std::vector<StepPicture> draw_method_steps(const std::vector<semantic_map::tile::VotedTile>& tiles,
                                                         const cloud_map::CloudMapOptions& options, double range);

}  // namespace curbstone::detect
