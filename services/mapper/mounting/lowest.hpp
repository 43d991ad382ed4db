#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>

namespace curbstone::mapper::mounting {

/// Where the residuals are lowest: an index, between two of them by the parabola through the lowest and its neighbours.
/// Nothing if that exceeds `most`, or is the first or the last one.
template <std::size_t N>
[[nodiscard]] std::optional<double> lowest(const std::array<double, N>& residuals, double most) {
  const auto least = std::min_element(residuals.begin(), residuals.end());
  if (*least > most || least == residuals.begin() || least + 1 == residuals.end()) return std::nullopt;
  const double before = *(least - 1), after = *(least + 1);
  const double bend = before - 2 * *least + after;
  const double beside = bend > 0 ? 0.5 * (before - after) / bend : 0;
  return static_cast<double>(least - residuals.begin()) + beside;
}

}  // namespace curbstone::mapper::mounting
