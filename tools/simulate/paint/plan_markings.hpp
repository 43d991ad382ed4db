#pragma once

#include <vector>

#include "tools/simulate/numerics/random.hpp"
#include "tools/simulate/paint/markings.hpp"
#include "tools/simulate/world/town.hpp"

namespace curbstone::simulate::paint {

/// Plans the markings of a town with right-hand traffic. On the driven street: centre line (dashed, solid in bends and
/// before crossings, double on some bends), lines along the curb or the parked cars, zebra crossings, half of them with
/// stop lines. On the others: centre line, and a stop line where they meet the first, some with a crossing and an
/// arrow. Nothing is painted within junctions. Some stretches have none.
[[nodiscard]] std::vector<Marking> plan_markings(const world::Town& town, numerics::Random random);

}  // namespace curbstone::simulate::paint
