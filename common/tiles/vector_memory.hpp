#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace curbstone {

/// @file
/// The memory of vectors of which a map has thousands.

/// Room for `more`, and an eighth of what there is: twice of it, as a vector makes by itself, is memory that most of
/// them never use.
template <class T>
void make_room(std::size_t more, std::vector<T>& values) {
  if (values.size() + more > values.capacity()) values.reserve(values.size() + std::max(more, values.size() / 8));
}

/// Empties it. `= {}` would keep the memory, as clear() does.
template <class T>
void give_back(std::vector<T>& values) {
  values = std::vector<T>();
}

}  // namespace curbstone
