#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace curbstone {

namespace quantile_detail {

/// Moves the values for which less(value, pivot) is true before the others, and returns their number. Without branches,
/// because they would be mispredicted.
template <class Less>
std::size_t partition_by(std::span<double> values, double pivot, Less less) {
  std::size_t before = 0;
  for (double& value : values) {
    const double here = value;
    value = values[before];
    values[before] = here;
    before += less(here, pivot) ? 1U : 0U;
  }
  return before;
}

/// The value that would be at `rank` if the values were sorted. Faster than std::nth_element(), which branches at each.
inline double select_in_place(std::span<double> values, std::size_t rank) {
  constexpr std::size_t kFew = 12;
  constexpr int kRounds = 40;  // rarely ten are needed, but pivots may be bad
  for (int round = 0; round < kRounds && values.size() > kFew; ++round) {
    const double a = values.front();
    const double b = values[values.size() / 2];
    const double c = values.back();
    const double pivot = std::max(std::min(a, b), std::min(std::max(a, b), c));
    const std::size_t below = partition_by(values, pivot, std::less<>());
    if (rank < below) {
      values = values.first(below);
      continue;
    }
    values = values.subspan(below);
    rank -= below;
    if (below > 0) continue;
    const std::size_t equal = partition_by(values, pivot, std::less_equal<>());
    if (rank < equal) return pivot;
    values = values.subspan(equal);
    rank -= equal;
  }
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace quantile_detail

/// The q-quantile, 0 <= q <= 1, of at least one value, by the nearest rank: of n values in ascending order the one at
/// index q (n - 1), rounded half up. The result is always one of the values: q = 0 gives the smallest, q = 1 the
/// greatest, and the median of an even number of values is the upper of the middle two. Takes linear time and reorders
/// the values.
[[nodiscard]] inline double quantile_in_place(std::span<double> values, double q) {
  assert(!values.empty());
  const auto rank = static_cast<std::size_t>(q * static_cast<double>(values.size() - 1) + 0.5);
  return quantile_detail::select_in_place(values, rank);
}

/// quantile_in_place() of a copy; `none` if there are no values.
[[nodiscard]] inline double quantile_or(std::vector<double> values, double q, double none) {
  return values.empty() ? none : quantile_in_place(values, q);
}

}  // namespace curbstone
