#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "common/statistics/quantile.hpp"

namespace curbstone::mapper::mounting {

/// The median of at least `least` values whose middle half spans `spread` at most to either side; nothing of others.
[[nodiscard]] inline std::optional<double> agreed(std::vector<double> values, double spread, std::size_t least) {
  if (values.size() < least) return std::nullopt;
  if (quantile_in_place(values, 0.75) - quantile_in_place(values, 0.25) > 2 * spread) return std::nullopt;
  return quantile_in_place(values, 0.5);
}

}  // namespace curbstone::mapper::mounting
