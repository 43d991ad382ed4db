#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "common/statistics/quantile.hpp"

namespace curbstone::mapper::mounting {

/// The median of at least `least` values, if their middle half spans at most 2 `spread`; otherwise none.
[[nodiscard]] inline std::optional<double> agreed(std::vector<double> values, double spread, std::size_t least) {
  if (values.size() < least) return std::nullopt;
  if (quantile_in_place(values, 0.75) - quantile_in_place(values, 0.25) > 2 * spread) return std::nullopt;
  return quantile_in_place(values, 0.5);
}

}  // namespace curbstone::mapper::mounting
