#pragma once

#include <cstddef>
#include <vector>

#include "tools/simulate/numerics/random.hpp"

namespace curbstone::simulate::world {

/// The style of a part of a town. The defaults are the demo's suburb.
struct Quarter {
  struct Bounds {
    double from, to;
    [[nodiscard]] double draw(numerics::Random& random) const { return random.uniform(from, to); }
  };
  Bounds plot{13.5, 18.5};          ///< m along the street
  double houses = 1.0;              ///< share of the plots with a house
  Bounds width{9.0, 13.0};          ///< m, of a house
  Bounds height{5.0, 8.5};          ///< m
  Bounds setback{5.5, 8.5};         ///< m behind the curb
  double fences = 0.45;             ///< share of the fronts
  double fences_and_hedges = 0.80;  ///< share of the fronts with either; the rest is open
  double garden_trees = 0.35;       ///< per plot
  double parking = 1.0;             ///< number of parked cars relative to the suburb
  bool lamps_and_bins = true;
  Bounds between_trees{14.0, 24.0};  ///< m, along the pavement
};

/// The style of each part of a street: equal stretches, street by street. Streets without a row are suburb.
struct Quarters {
  struct Row {
    double stretch = 1e9;  ///< m
    std::vector<Quarter> quarters;
  };
  std::vector<Row> rows;

  [[nodiscard]] const Quarter& at(std::size_t street, double s) const {
    static const Quarter kSuburb;
    if (street >= rows.size() || rows[street].quarters.empty()) return kSuburb;
    const auto i = static_cast<std::size_t>(s < 0 ? 0.0 : s / rows[street].stretch);
    return rows[street].quarters[i < rows[street].quarters.size() ? i : rows[street].quarters.size() - 1];
  }
};

}  // namespace curbstone::simulate::world
