#pragma once

#include <numeric>
#include <vector>

#include "common/statistics/quantile.hpp"

namespace curbstone::bench::voting {

/// ms per revolution.
struct ScanTimes {
  double mean_ms = 0;
  double p99_ms = 0;
  double max_ms = 0;
};

[[nodiscard]] inline ScanTimes scan_times(const std::vector<double>& ms) {
  if (ms.empty()) return {};
  const double sum = std::accumulate(ms.begin(), ms.end(), 0.0);
  return {sum / static_cast<double>(ms.size()), quantile_or(ms, 0.99, 0), quantile_or(ms, 1, 0)};
}

}  // namespace curbstone::bench::voting
