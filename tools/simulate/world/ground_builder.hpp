#pragma once

#include <vector>

#include "tools/simulate/random.hpp"
#include "tools/simulate/world/ground.hpp"
#include "tools/simulate/world/street.hpp"

namespace curbstone {

/// Lays streets over rolling terrain: where they meet, their curbs join in arcs.
[[nodiscard]] Ground build_ground(const std::vector<Street>& streets, const StreetProfile& profile, Random random);

}  // namespace curbstone
