#pragma once

#include <vector>

#include "tools/simulate/numerics/random.hpp"
#include "tools/simulate/world/quarter.hpp"
#include "tools/simulate/world/street.hpp"

namespace curbstone::simulate::world {

/// The streets of a town before curbs and houses.
struct TownPlan {
  std::vector<Street> streets;  ///< 0 is the loop, counter-clockwise, or the straight street
  Quarters quarters;
  std::size_t inside = 1;  ///< number of streets that end within the world
};

/// The demo's town: a street around one block, three side streets.
[[nodiscard]] TownPlan plan_block(double half_width, numerics::Random& random);

/// A loop of `round` metres through streets of several blocks, which are at least a tenth of `round` apart except at
/// corners. Street 1, off the loop, ends within the world: the way in and out. Other streets lead out of the town or
/// across its blocks. Neighbouring parts of the town differ in style.
[[nodiscard]] TownPlan plan_blocks(double round, double half_width, numerics::Random& random);

/// A straight street, open at both ends: suburb along its first and last quarter, and only curbs between.
[[nodiscard]] TownPlan plan_straight(double length, double half_width, numerics::Random& random);

}  // namespace curbstone::simulate::world
