#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace curbstone {

/// @file
/// The memory of vectors of which a map has thousands.

/// Makes room for `more` elements; a vector that must grow grows by at least an eighth. The doubling that a vector does
/// by itself is memory that most of these vectors never use.
template <class T>
void make_room(std::size_t more, std::vector<T>& values) {
  if (values.size() + more > values.capacity()) values.reserve(values.size() + std::max(more, values.size() / 8));
}

/// Empties the vector and frees its memory. `= {}` and clear() would keep the memory.
template <class T>
void release_memory(std::vector<T>& values) {
  values = std::vector<T>();
}

}  // namespace curbstone
