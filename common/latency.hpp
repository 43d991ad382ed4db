#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace curbstone {

/// The last N values of something; percentiles on request. Bounded, allocation-free once full.
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
    if (values_.empty()) return std::numeric_limits<double>::quiet_NaN();
    std::vector<double> sorted = values_;
    const auto index = static_cast<std::size_t>(q * static_cast<double>(sorted.size() - 1) + 0.5);
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(index), sorted.end());
    return sorted[index];
  }

 private:
  std::size_t capacity_;
  std::size_t next_ = 0;
  std::vector<double> values_;
};

}  // namespace curbstone
