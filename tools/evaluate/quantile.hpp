#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace curbstone {

/// The value below which a share `q` (0..1) of them lies, by the nearest rank; 0 if there are none.
[[nodiscard]] inline double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1) + 0.5)];
}

}  // namespace curbstone
