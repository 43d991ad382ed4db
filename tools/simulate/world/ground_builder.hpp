#pragma once

#include <vector>

#include "tools/simulate/numerics/random.hpp"
#include "tools/simulate/world/ground.hpp"
#include "tools/simulate/world/street.hpp"

namespace curbstone::simulate::world {

/// Lays streets over rolling terrain: where they meet, their curbs join in arcs. The first `inside` of the streets lie
/// within the world with room around them; the others may run off its edge.
[[nodiscard]] Ground build_ground(const std::vector<Street>& streets, std::size_t inside, const StreetProfile& profile,
                                  numerics::Random random);

}  // namespace curbstone::simulate::world
