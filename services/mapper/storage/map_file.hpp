#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace curbstone::mapper::storage {

/// Files of a map folder. Everything throws MapFolderError.

void write_map_file(const std::filesystem::path& path, std::string_view bytes);
/// Refuses what is no file or larger than `max_size`.
[[nodiscard]] std::size_t map_file_size(const std::filesystem::path& path, std::size_t max_size);
[[nodiscard]] std::string read_map_file(const std::filesystem::path& path, std::size_t max_size);

/// One row of a CSV file of numbers, taken from left to right.
class MapRow {
 public:
  /// `where` names file and line in errors.
  MapRow(std::string_view text, std::string where) : rest_(text), where_(std::move(where)) {}
  [[nodiscard]] std::int64_t integer(std::int64_t min, std::int64_t max);
  [[nodiscard]] double number();  ///< finite
  /// That there is nothing more.
  void end() const;
  [[noreturn]] void fail(const std::string& what) const;

 private:
  template <class Number>
  [[nodiscard]] Number next(const char* expected);
  std::string_view rest_;
  std::string where_;
  bool more_ = true;
};

/// The lines of a CSV file below its first, which must be `header`: exactly `rows`, at most kMaxMapRow long.
inline constexpr std::size_t kMaxMapRow = 2000;  ///< bytes
[[nodiscard]] std::vector<std::string> read_map_rows(const std::filesystem::path& path, std::string_view header,
                                                     std::size_t rows);

}  // namespace curbstone::mapper::storage
