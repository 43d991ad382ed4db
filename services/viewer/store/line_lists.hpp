#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace curbstone::viewer::store {

/// Whether a list of a line's message can be drawn: n numbers, finite and below 1e7 in magnitude.
inline bool is_drawable(const std::vector<float>& list, std::size_t n) {
  return list.size() == n &&
         std::all_of(list.begin(), list.end(), [](float v) { return std::isfinite(v) && std::abs(v) < 1e7F; });
}

template <class Value>
std::vector<Value> part_of(const std::vector<Value>& list, std::size_t first, std::size_t last) {
  return {list.begin() + static_cast<std::ptrdiff_t>(first), list.begin() + static_cast<std::ptrdiff_t>(last)};
}

}  // namespace curbstone::viewer::store
