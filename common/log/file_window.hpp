#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace curbstone {

/// A large file of which one part at a time is in memory. One thread.
class FileWindow {
 public:
  /// Throws std::runtime_error with one clear line. Data written to the file later is not seen.
  explicit FileWindow(const std::string& file);
  ~FileWindow();
  FileWindow(const FileWindow&) = delete;
  FileWindow& operator=(const FileWindow&) = delete;

  [[nodiscard]] std::int64_t size() const { return size_; }
  /// `count` bytes from `from` on; fewer at the end of the file and where the disk cannot be read. Valid until the next
  /// call.
  [[nodiscard]] std::span<const std::uint8_t> at(std::int64_t from, std::size_t count);
  /// The position of the first occurrence of `bytes` at or after `from`; size() if there is none.
  [[nodiscard]] std::int64_t find(std::span<const std::uint8_t> bytes, std::int64_t from);

 private:
  int fd_ = -1;
  std::int64_t size_ = 0;
  std::int64_t begin_ = 0;
  std::vector<std::uint8_t> window_;
};

}  // namespace curbstone
