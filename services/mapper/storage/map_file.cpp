#include "services/mapper/storage/map_file.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>

#include "services/mapper/storage/saved_map.hpp"

namespace curbstone::mapper::storage {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail(const fs::path& path, const std::string& what) {
  throw MapFolderError(fmt::format("{}: {}", path.string(), what));
}

}  // namespace

void write_map_file(const fs::path& path, std::string_view bytes) {
  errno = 0;
  std::ofstream out(path, std::ios::binary);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (!out) fail(path, fmt::format("cannot be written: {}", std::strerror(errno)));
}

std::size_t map_file_size(const fs::path& path, std::size_t max_size) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) fail(path, "is missing");
  if (!fs::is_regular_file(status)) fail(path, "is not a file");
  const auto size = static_cast<std::size_t>(fs::file_size(path, error));
  if (error) fail(path, error.message());
  if (size > max_size) fail(path, fmt::format("{} bytes; a map's has at most {}", size, max_size));
  return size;
}

std::string read_map_file(const fs::path& path, std::size_t max_size) {
  std::string bytes(map_file_size(path, max_size), '\0');
  std::ifstream in(path, std::ios::binary);
  if (!in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) fail(path, "cannot be read");
  return bytes;
}

template <class Number>
Number MapRow::next(const char* expected) {
  const std::size_t comma = rest_.find(',');
  const std::string_view word = rest_.substr(0, comma);
  Number value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (!more_ || error != std::errc() || end != word.data() + word.size())
    fail(fmt::format("\"{}\": expected {}", word.substr(0, 40), expected));
  more_ = comma != std::string_view::npos;
  rest_ = more_ ? rest_.substr(comma + 1) : std::string_view();
  return value;
}

std::int64_t MapRow::integer(std::int64_t min, std::int64_t max) {
  const auto value = next<std::int64_t>("a whole number");
  if (value < min || value > max) fail(fmt::format("{}: expected {} to {}", value, min, max));
  return value;
}

double MapRow::number() {
  const auto value = next<double>("a number");
  if (!std::isfinite(value)) fail("expected a finite number");
  return value;
}

void MapRow::end() const {
  if (more_) fail("has too many columns");
}

void MapRow::fail(const std::string& what) const {
  throw MapFolderError(fmt::format("{}: {}", where_, what));
}

std::vector<std::string> read_map_rows(const fs::path& path, std::string_view header, std::size_t rows) {
  const std::string text = read_map_file(path, kMaxMapRow * (rows + 1));
  std::vector<std::string> lines;
  std::size_t from = 0;
  for (std::size_t end = 0; (end = text.find('\n', from)) != std::string::npos; from = end + 1) {
    const std::string_view line = std::string_view(text).substr(from, end - from);
    if (from == 0 && line != header) fail(path, fmt::format("does not begin with \"{}\"", header));
    if (from != 0) lines.emplace_back(line);
  }
  if (from != text.size() || lines.size() != rows || from == 0)
    fail(path, fmt::format("{} rows; map.yaml has {}: truncated?", lines.size(), rows));
  return lines;
}

}  // namespace curbstone::mapper::storage
