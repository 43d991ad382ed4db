#include "services/mapper/storage/pcd_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <map>
#include <string>

#include "common/pcd/pcd_header.hpp"
#include "services/mapper/storage/map_file.hpp"
#include "services/mapper/storage/saved_map.hpp"

namespace curbstone::mapper::storage {

namespace {

constexpr std::size_t kMaxHeader = 4096;  // bytes

std::size_t words_in(std::string_view text) {
  return 1 + static_cast<std::size_t>(std::count(text.begin(), text.end(), ' '));
}

std::vector<PcdField> float_fields(std::string_view names) {
  std::vector<PcdField> fields;
  while (!names.empty()) {
    const std::size_t end = std::min(names.find(' '), names.size());
    fields.push_back({names.substr(0, end)});
    names.remove_prefix(std::min(end + 1, names.size()));
  }
  return fields;
}

std::string repeated(char letter, std::size_t times) {
  std::string text(1, letter);
  for (std::size_t i = 1; i < times; ++i) text += {' ', letter};
  return text;
}

/// The value of each keyword; `size` becomes the length of the header in bytes. Empty if the header has no end.
std::map<std::string, std::string, std::less<>> parse_header(std::string_view text, std::size_t& size) {
  std::map<std::string, std::string, std::less<>> header;
  for (size = 0; size < text.size();) {
    const std::size_t end = text.find('\n', size);
    if (end == std::string_view::npos) break;
    const std::string_view line = text.substr(size, end - size);
    size = end + 1;
    const std::size_t space = std::min(line.find(' '), line.size());
    header[std::string(line.substr(0, space))] = line.substr(std::min(space + 1, line.size()));
    if (line.starts_with("DATA")) return header;
  }
  return {};
}

}  // namespace

void write_pcd(const std::filesystem::path& path, std::string_view fields, const std::vector<float>& values,
               const Pose& viewpoint) {
  const std::size_t n = words_in(fields);
  std::string bytes = pcd_header(float_fields(fields), values.size() / n, viewpoint);
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
  write_map_file(path, bytes);
}

std::vector<float> read_pcd(const std::filesystem::path& path, std::string_view fields, std::size_t max_points) {
  const auto fail = [&](const std::string& what) { throw MapFolderError(fmt::format("{}: {}", path.string(), what)); };
  const std::size_t n = words_in(fields), step = n * sizeof(float);
  const std::size_t size = map_file_size(path, kMaxHeader + max_points * step);
  std::ifstream in(path, std::ios::binary);
  std::string start(std::min(size, kMaxHeader), '\0');
  if (!in.read(start.data(), static_cast<std::streamsize>(start.size()))) fail("cannot be read");
  std::size_t header_size = 0;
  const auto header = parse_header(start, header_size);
  const auto expect = [&](const char* key, std::string_view value) {
    const auto found = header.find(key);
    if (found == header.end() || found->second != value)
      fail(fmt::format("is no PCD cloud with \"{} {}\"", key, value));
  };
  expect("FIELDS", fields);
  expect("SIZE", repeated('4', n));
  expect("TYPE", repeated('F', n));
  expect("COUNT", repeated('1', n));
  expect("HEIGHT", "1");
  expect("DATA", "binary");
  const auto says = header.find("POINTS");
  std::size_t points = 0;
  if (says != header.end()) std::from_chars(says->second.data(), says->second.data() + says->second.size(), points);
  if (points != (size - header_size) / step || (size - header_size) % step != 0)
    fail(fmt::format("{} bytes of points are not the \"POINTS {}\" of its header: truncated?", size - header_size,
                     says == header.end() ? "" : says->second));
  expect("WIDTH", fmt::to_string(points));
  std::vector<float> values(points * n);
  in.seekg(static_cast<std::streamoff>(header_size));
  if (!in.read(reinterpret_cast<char*>(values.data()), static_cast<std::streamsize>(points * step)))
    fail("cannot be read");
  return values;
}

}  // namespace curbstone::mapper::storage
