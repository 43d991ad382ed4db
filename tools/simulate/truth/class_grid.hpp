#pragma once

#include "tools/simulate/truth/gray_image.hpp"
#include "tools/simulate/world/scene.hpp"

namespace curbstone::simulate::truth {

/// The town as the semantic map should show it: class ids of semantic_tile_t in cells of `resolution` m.
struct ClassGrid {
  double resolution = 0.12;
  double x0 = 0;  ///< m, lower-left corner, world frame; row 0 of the image is the highest y
  double y0 = 0;
  GrayImage image{0, 0};
};

/// Road is flat ground, pavement and lawn included, as far as 12 m behind a curb. Curb are the cells that a curb's face
/// passes through; where it is dropped (< 4 cm) a cell stays unknown: neither answer is wrong there. Obstacles are
/// lower than 1.2 m; cars and what is higher are wall or vehicle; what hangs above `vehicle_height` does not count, nor
/// do moving cars.
[[nodiscard]] ClassGrid make_class_grid(const world::Scene& scene, double vehicle_height,
                                        double resolution = ClassGrid{}.resolution);

/// m: the pixels from which the class of a map's own cell can be derived, whichever way its grid lies: a quarter of a
/// cell. That of ClassGrid in a town too large for it.
[[nodiscard]] double fine_resolution(const world::Scene& scene);

}  // namespace curbstone::simulate::truth
