#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "common/statistics/quantile.hpp"

namespace curbstone {

/// The median of at least `min_count` values, if their middle half spans at most 2 `spread`; otherwise none.
[[nodiscard]] inline std::optional<double> consistent_median(std::vector<double> values, double spread,
                                                             std::size_t min_count) {
  if (values.size() < min_count) return std::nullopt;
  if (quantile_in_place(values, 0.75) - quantile_in_place(values, 0.25) > 2 * spread) return std::nullopt;
  return quantile_in_place(values, 0.5);
}

}  // namespace curbstone
