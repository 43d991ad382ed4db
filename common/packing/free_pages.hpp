#pragma once

#include <cstdint>
#include <map>

namespace curbstone {

/// The free pages of a file. The file grows when none of its gaps is long enough.
class FreePages {
 public:
  /// Allocates `count` consecutive pages. Returns the first one.
  [[nodiscard]] std::uint64_t take(std::uint64_t count);
  /// Frees pages that take() returned.
  void release(std::uint64_t first, std::uint64_t count);
  /// Length of the file in pages, used or not.
  [[nodiscard]] std::uint64_t num_pages() const { return end_; }

 private:
  std::map<std::uint64_t, std::uint64_t> gaps_;  // first page: count; no gap touches another gap or the end of the file
  std::uint64_t end_ = 0;
};

}  // namespace curbstone
