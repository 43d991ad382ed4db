#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <system_error>

#include "common/packing/free_pages.hpp"

namespace curbstone {

/// A file without a name, which disappears with its last user, and the pages of it that are free. The disk is accessed
/// by write(), read() and trim(), any thread; the caller guards `pages` and `length`.
class UnnamedFile {
 public:
  static constexpr std::uint64_t kPage = 4096;  ///< bytes

  /// Throws std::system_error if the folder takes no file.
  explicit UnnamedFile(const std::string& folder);
  ~UnnamedFile();
  UnnamedFile(const UnnamedFile&) = delete;
  UnnamedFile& operator=(const UnnamedFile&) = delete;

  /// Whether the disk has so many bytes for this process; true if the disk does not say.
  [[nodiscard]] bool has_room_for(std::uint64_t bytes) const;
  [[nodiscard]] std::error_code write(std::uint64_t page, std::span<const std::byte> bytes) const;
  [[nodiscard]] std::error_code read(std::uint64_t page, std::span<std::byte> bytes) const;
  /// Cuts off everything from this page on.
  void trim(std::uint64_t page) const;

  FreePages pages;
  std::uint64_t length = 0;  ///< pages on the disk; some may be free

 private:
  int descriptor_;
};

}  // namespace curbstone
