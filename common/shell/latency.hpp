#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "common/statistics/quantile.hpp"

namespace curbstone {

/// The last `capacity` values, in any unit, with percentiles on request. add() does not allocate; percentile() copies
/// the values.
class LatencyWindow {
 public:
  explicit LatencyWindow(std::size_t capacity = 256) : capacity_(capacity) { values_.reserve(capacity); }
  void add(double value) {
    if (values_.size() < capacity_)
      values_.push_back(value);
    else
      values_[next_] = value;
    next_ = (next_ + 1) % capacity_;
  }
  void clear() {
    values_.clear();
    next_ = 0;
  }
  /// q in 0..1; NaN when empty.
  [[nodiscard]] double percentile(double q) const {
    return quantile_or(values_, q, std::numeric_limits<double>::quiet_NaN());
  }

 private:
  std::size_t capacity_;
  std::size_t next_ = 0;
  std::vector<double> values_;
};

}  // namespace curbstone
