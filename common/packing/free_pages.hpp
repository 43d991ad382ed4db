#pragma once

#include <cstdint>
#include <map>

namespace curbstone {

/// Which pages of a file are free. It grows when none of its gaps is long enough.
class FreePages {
 public:
  /// The first of `count` pages in a row, which are no longer free.
  [[nodiscard]] std::uint64_t take(std::uint64_t count);
  /// Pages that were taken.
  void give_back(std::uint64_t first, std::uint64_t count);
  /// Of the file, used or not.
  [[nodiscard]] std::uint64_t num_pages() const { return end_; }

 private:
  std::map<std::uint64_t, std::uint64_t> gaps_;  // first page: count; none touch each other or the end
  std::uint64_t end_ = 0;
};

}  // namespace curbstone
