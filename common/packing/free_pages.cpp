#include "common/packing/free_pages.hpp"

#include <algorithm>
#include <iterator>

namespace curbstone {

std::uint64_t FreePages::take(std::uint64_t count) {
  const auto gap = std::find_if(gaps_.begin(), gaps_.end(), [&](const auto& g) { return g.second >= count; });
  if (gap == gaps_.end()) {
    end_ += count;
    return end_ - count;
  }
  const auto [first, length] = *gap;
  gaps_.erase(gap);
  if (length > count) gaps_.emplace(first + count, length - count);
  return first;
}

void FreePages::release(std::uint64_t first, std::uint64_t count) {
  auto next = gaps_.upper_bound(first);
  if (next != gaps_.end() && next->first == first + count) {
    count += next->second;
    next = gaps_.erase(next);
  }
  if (next != gaps_.begin()) {
    const auto before = std::prev(next);
    if (before->first + before->second == first) {
      first = before->first;
      count += before->second;
      gaps_.erase(before);
    }
  }
  if (first + count == end_) {
    end_ = first;
  } else {
    gaps_.emplace(first, count);
  }
}

}  // namespace curbstone
