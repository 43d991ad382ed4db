#pragma once

#include <vector>

#include "tools/simulate/numerics/random.hpp"
#include "tools/simulate/world/ground.hpp"
#include "tools/simulate/world/street.hpp"

namespace curbstone::simulate::world {

/// Builds rolling terrain with the streets; where streets meet, their curbs join in arcs. The first `inside` streets
/// lie within the world with a margin; the others may run off its edge.
[[nodiscard]] Ground build_ground(const std::vector<Street>& streets, std::size_t inside, const StreetProfile& profile,
                                  numerics::Random random);

}  // namespace curbstone::simulate::world
