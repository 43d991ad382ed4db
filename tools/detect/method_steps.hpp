#pragma once

#include <string>
#include <vector>

#include "services/semantic_map/drawing.hpp"
#include "tools/detect/cloud_map.hpp"

namespace curbstone {

/// A picture of what one step of the method has made of a cloud.
struct StepPicture {
  std::string name;  ///< as "3_road_height"
  Canvas canvas;
};

/// The method step by step, as the paper's Fig. 8-12: stick share, direction of the normal, road height at 0.5 m, DEM,
/// tilt against the ground, curb evidence, what the filter leaves. From above, x to the right, 5 cm a pixel or more;
/// tiles farther than `range` m from the origin are left out (0: none are).
[[nodiscard]] std::vector<StepPicture> draw_method_steps(const std::vector<VotedTile>& tiles,
                                                         const CloudMapOptions& options, double range);

}  // namespace curbstone
