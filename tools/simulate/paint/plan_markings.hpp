#pragma once

#include <vector>

#include "tools/simulate/numerics/random.hpp"
#include "tools/simulate/paint/markings.hpp"
#include "tools/simulate/world/town.hpp"

namespace curbstone::simulate::paint {

/// The markings of a town, right-hand traffic. Along the street that is driven: centre line (dashed, solid in bends and
/// before crossings, double on some bends), lines along the curb or the parked cars, zebra crossings, half of them with
/// stop lines. Along the others: centre line, and where they meet the first a stop line, some with a crossing and an
/// arrow. Nothing is painted where streets meet. Some stretches have none.
[[nodiscard]] std::vector<Marking> plan_markings(const world::Town& town, numerics::Random random);

}  // namespace curbstone::simulate::paint
