#pragma once

#include "tools/simulate/truth/gray_image.hpp"
#include "tools/simulate/world/scene.hpp"

namespace curbstone::simulate::truth {

/// The expected semantic map of the town: class ids of semantic_tile_t in cells of `resolution` m.
struct ClassGrid {
  double resolution = 0.12;
  double x0 = 0;  ///< m, lower-left corner, world frame; row 0 of the image is the highest y
  double y0 = 0;
  GrayImage image{0, 0};
};

/// Road is flat ground, including pavement and lawn, as far as 12 m behind a curb. Curb are the cells that a curb's
/// face passes through; where the curb is lowered (< 4 cm) a cell is unknown, so that neither answer is wrong.
/// Obstacles are lower than 1.2 m; cars and higher objects are wall or vehicle; objects above `vehicle_height` and
/// moving cars do not count.
[[nodiscard]] ClassGrid make_class_grid(const world::Scene& scene, double vehicle_height,
                                        double resolution = ClassGrid{}.resolution);

/// m, the pixel size from which the class of a map cell can be derived for any alignment of the map's grid: a quarter
/// of a cell. For a town too large for that, the pixel size of ClassGrid.
[[nodiscard]] double fine_resolution(const world::Scene& scene);

}  // namespace curbstone::simulate::truth
