#pragma once

#include <vector>

#include "tools/simulate/numerics/random.hpp"
#include "tools/simulate/world/street.hpp"

namespace curbstone::simulate::world {

/// Adds a street of `length` m that branches off the first one, at about a right angle, at `s` m along it.
void add_side_street(std::vector<Street>& streets, double s, Side side, double length, numerics::Random& random);

}  // namespace curbstone::simulate::world
