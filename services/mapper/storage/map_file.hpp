#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace curbstone::mapper::storage {

/// Reading and writing of the files of a map folder. All functions throw MapFolderError.

void write_map_file(const std::filesystem::path& path, std::string_view bytes);
/// Size in bytes. Refuses what is not a file, and what is larger than `max_size`.
[[nodiscard]] std::size_t map_file_size(const std::filesystem::path& path, std::size_t max_size);
[[nodiscard]] std::string read_map_file(const std::filesystem::path& path, std::size_t max_size);

/// One row of a CSV file of numbers, read from left to right.
class MapRow {
 public:
  /// `where` names file and line in errors.
  MapRow(std::string_view text, std::string where) : rest_(text), where_(std::move(where)) {}
  [[nodiscard]] std::int64_t integer(std::int64_t min, std::int64_t max);
  [[nodiscard]] double number();  ///< finite
  /// Checks that the row ends here.
  void end() const;
  [[noreturn]] void fail(const std::string& what) const;

 private:
  template <class Number>
  [[nodiscard]] Number next(const char* expected);
  std::string_view rest_;
  std::string where_;
  bool more_ = true;
};

/// The lines of a CSV file after its first, which must be `header`: exactly `rows`, at most kMaxMapRow bytes each.
inline constexpr std::size_t kMaxMapRow = 2000;  ///< bytes
[[nodiscard]] std::vector<std::string> read_map_rows(const std::filesystem::path& path, std::string_view header,
                                                     std::size_t rows);

}  // namespace curbstone::mapper::storage
