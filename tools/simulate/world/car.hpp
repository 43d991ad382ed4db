#pragma once

#include <Eigen/Core>
#include <vector>

#include "tools/simulate/world/shapes.hpp"

namespace curbstone::simulate::world {

/// Adds a car's body, cabin and wheels, with the centre of its footprint at `ground`.
void add_car(std::vector<Shape>& shapes, const Eigen::Vector3d& ground, double yaw, float reflectivity);

}  // namespace curbstone::simulate::world
