#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "tools/simulate/numerics/random.hpp"
#include "tools/simulate/world/ground.hpp"
#include "tools/simulate/world/quarter.hpp"
#include "tools/simulate/world/shapes.hpp"
#include "tools/simulate/world/street.hpp"

namespace curbstone::simulate::world {

/// A piece of land along a street with a house on it.
struct Plot {
  std::size_t street = 0;
  Side side = Side::kLeft;
  double from = 0;  ///< m along the street
  double to = 0;
  bool driveway = false;  ///< at the end of the plot
};

/// Where a driveway crosses the pavement.
struct Driveway {
  std::size_t street = 0;
  Side side = Side::kLeft;
  double s = 0;
  double half = 1.7;
  double height = 0.02;  ///< m, of the dropped kerb
};

/// What is decided before the ground exists: plots, and the driveways for which curbs are lowered.
struct ObjectPlan {
  std::vector<Plot> plots;
  std::vector<Driveway> driveways;
};

[[nodiscard]] ObjectPlan plan_objects(const std::vector<Street>& streets, const Quarters& quarters,
                                      numerics::Random random);

/// Makes houses, fences, hedges, trees, lamps, parked cars, bins and boxes; none stands in another street or in a
/// house. With `passing`, cars and bins are drawn from it, and everything else is unchanged: the same town on another
/// day.
[[nodiscard]] std::vector<Shape> place_objects(const ObjectPlan& plan, const std::vector<Street>& streets,
                                               const Quarters& quarters, const Ground& ground, numerics::Random random,
                                               const std::optional<numerics::Random>& passing = {});

}  // namespace curbstone::simulate::world
