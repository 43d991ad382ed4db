#include <cmath>

#include "tools/simulate/world/town_plan.hpp"

namespace curbstone::simulate::world {

namespace {

/// No objects: a road between fields, with its curbs.
Quarter bare() {
  Quarter quarter;
  quarter.houses = quarter.fences = quarter.fences_and_hedges = quarter.garden_trees = quarter.parking = 0;
  quarter.lamps_and_bins = false;
  quarter.between_trees = {1e6, 1e6};
  return quarter;
}

}  // namespace

TownPlan plan_straight(double length, double half_width, numerics::Random& random) {
  TownPlan plan;
  const double heading = random.uniform(0.1, 0.3);
  std::vector<Eigen::Vector2d> points;
  for (double s = 0; s <= length; s += 5.0) points.emplace_back(s * std::cos(heading), s * std::sin(heading));
  plan.streets.emplace_back(numerics::Spline<Eigen::Vector2d>(points, false), half_width);
  plan.quarters.rows.push_back({length / 4, {Quarter{}, bare(), bare(), Quarter{}}});
  return plan;
}

}  // namespace curbstone::simulate::world
