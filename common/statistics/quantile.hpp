#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <span>
#include <vector>

namespace curbstone {

/// The q-quantile, 0 <= q <= 1, of at least one value, by the nearest rank: of n values in ascending order the one at
/// index q (n - 1), rounded half up. The result is always one of the values: q = 0 gives the smallest, q = 1 the
/// greatest, and the median of an even number of values is the upper of the middle two. Takes linear time and reorders
/// the values.
[[nodiscard]] inline double quantile_in_place(std::span<double> values, double q) {
  assert(!values.empty());
  const auto rank = static_cast<std::size_t>(q * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(rank), values.end());
  return values[rank];
}

/// quantile_in_place() of a copy; `none` if there are no values.
[[nodiscard]] inline double quantile_or(std::vector<double> values, double q, double none) {
  return values.empty() ? none : quantile_in_place(values, q);
}

}  // namespace curbstone
