#include "tools/detect/pcd_file.hpp"

#include <fmt/format.h>
#include <pcl/io/lzf.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <numeric>
#include <set>
#include <string>

#include "tools/detect/cloud_file_error.hpp"
#include "tools/detect/text_rows.hpp"

namespace curbstone::detect {

namespace {

const std::set<std::string_view> kKeys = {"VERSION", "FIELDS", "SIZE",      "TYPE",   "COUNT",
                                          "WIDTH",   "HEIGHT", "VIEWPOINT", "POINTS", "DATA"};

struct Field {
  std::string name;
  std::string type;         // F, U or I
  std::uint64_t size = 0;   // bytes of a number
  std::uint64_t count = 1;  // numbers of the field
  [[nodiscard]] std::uint64_t bytes() const { return size * count; }
};

struct Header {
  std::vector<Field> fields;
  std::uint64_t points = 0;
  std::string data;

  [[nodiscard]] std::uint64_t point_bytes() const {
    return std::accumulate(fields.begin(), fields.end(), std::uint64_t{0},
                           [](std::uint64_t sum, const Field& field) { return sum + field.bytes(); });
  }
  [[nodiscard]] std::size_t columns() const {
    return std::accumulate(fields.begin(), fields.end(), std::size_t{0},
                           [](std::size_t sum, const Field& field) { return sum + field.count; });
  }
};

/// The coordinate of one axis of the points, in bytes.
struct Axis {
  std::uint64_t begin, step;
  bool is_double;
};

class PcdReader {
 public:
  explicit PcdReader(const std::filesystem::path& path)
      : path_(path), size_(std::filesystem::file_size(path)), in_(path, std::ios::binary), lines_(in_) {}

  Header read_header() {
    constexpr int kMaxLines = 1000;
    Header header;
    std::map<std::string, std::vector<std::string>, std::less<>> said;
    while (!said.contains("DATA") && lines_.number() < kMaxLines && lines_.next()) {
      std::string_view rest = lines_.line();
      const std::string_view key = next_word(rest);
      if (key.empty() || key.starts_with('#')) continue;
      if (!kKeys.contains(key)) fail(fmt::format("is not a pcd cloud: line {} is none of its header", lines_.number()));
      std::vector<std::string>& words = said[std::string(key)];
      words.clear();
      for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) words.emplace_back(word);
    }
    for (const char* key : {"FIELDS", "SIZE", "TYPE", "WIDTH", "HEIGHT", "POINTS", "DATA"}) {
      if (!said.contains(key)) fail(fmt::format("is not a pcd cloud: its header has no {}", key));
    }
    const auto number_of = [&](const char* key, std::size_t i) {
      const auto number = number_in<std::uint64_t>(said[key][i]);
      if (!number) fail(fmt::format("{} of its header is no number", key));
      return *number;
    };
    const std::size_t fields = said["FIELDS"].size();
    for (const char* key : {"SIZE", "TYPE", "COUNT"}) {
      if (said.contains(key) && said[key].size() != fields) contradicts();
    }
    for (std::size_t i = 0; i < fields; ++i) {
      constexpr std::uint64_t kMaxCount = 100'000;
      header.fields.push_back({said["FIELDS"][i], said["TYPE"][i], number_of("SIZE", i),
                               said.contains("COUNT") ? number_of("COUNT", i) : 1});
      if (header.fields.back().size > 8 || header.fields.back().count > kMaxCount) contradicts();
    }
    for (const char* key : {"WIDTH", "HEIGHT", "POINTS", "DATA"}) {
      if (said[key].size() != 1) fail(fmt::format("{} of its header is not one word", key));
    }
    header.points = number_of("POINTS", 0);
    const std::uint64_t width = number_of("WIDTH", 0), height = number_of("HEIGHT", 0);
    if (header.points > kMaxCompression * size_ || width > header.points ||
        height > std::max<std::uint64_t>(header.points, 1) || width * height != header.points)
      contradicts();
    header.data = said["DATA"][0];
    return header;
  }

  std::vector<Eigen::Vector3f> read_rows(const Header& header, const Eigen::Vector3d& origin) {
    std::array<std::size_t, 3> axes{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t field = field_of(header, axis);
      for (std::size_t i = 0; i < field; ++i) axes[axis] += header.fields[i].count;
    }
    std::vector<double> values(header.columns());
    std::vector<Eigen::Vector3f> points;
    while (lines_.next()) {
      std::string_view rest = lines_.line();
      std::string_view word = next_word(rest);
      if (word.empty()) continue;
      if (points.size() == header.points)
        fail_here(fmt::format("more than the {} points of the header", header.points));
      for (double& value : values) {
        const auto number = number_in(word);
        if (!number)
          fail_here(word.empty() ? "too few numbers" : fmt::format("\"{}\" is no number", word.substr(0, 20)));
        value = *number;
        word = next_word(rest);
      }
      if (!word.empty()) fail_here("more numbers than fields");
      points.push_back((Eigen::Vector3d(values[axes[0]], values[axes[1]], values[axes[2]]) - origin).cast<float>());
    }
    if (points.size() < header.points) fail(fmt::format("truncated: {} of {} points", points.size(), header.points));
    return points;
  }

  /// One point after the other.
  std::vector<Eigen::Vector3f> read_records(const Header& header, const Eigen::Vector3d& origin) {
    const std::uint64_t step = header.point_bytes();
    if (header.points * step > left()) fail("truncated");
    std::array<Axis, 3> axes{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t field = field_of(header, axis);
      std::uint64_t begin = 0;
      for (std::size_t i = 0; i < field; ++i) begin += header.fields[i].bytes();
      axes[axis] = {begin, step, header.fields[field].size == 8};
    }
    return points_of(take(header.points * step), axes, header.points, origin);
  }

  /// LZF-compressed, one field after the other.
  std::vector<Eigen::Vector3f> read_compressed(const Header& header, const Eigen::Vector3d& origin) {
    const std::vector<char> sizes = take(std::min<std::uint64_t>(left(), 8));
    if (sizes.size() < 8) fail("truncated");
    std::uint32_t small = 0, large = 0;
    std::memcpy(&small, sizes.data(), 4);
    std::memcpy(&large, sizes.data() + 4, 4);
    if (small > left()) fail("truncated");
    if (large != header.points * header.point_bytes() || large > kMaxCompression * small) contradicts();
    const std::vector<char> compressed = take(small);
    std::vector<char> bytes(large);
    if (large > 0 && pcl::lzfDecompress(compressed.data(), small, bytes.data(), large) != large)
      fail("its compressed points are damaged");
    std::array<Axis, 3> axes{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t field = field_of(header, axis);
      std::uint64_t begin = 0;
      for (std::size_t i = 0; i < field; ++i) begin += header.points * header.fields[i].bytes();
      axes[axis] = {begin, header.fields[field].size, header.fields[field].size == 8};
    }
    return points_of(bytes, axes, header.points, origin);
  }

 private:
  static constexpr std::uint64_t kMaxCompression = 264;  // bytes that LZF makes of one, at most

  [[noreturn]] void fail(const std::string& why) const {
    throw CloudFileError(fmt::format("{}: {}", path_.string(), why));
  }
  [[noreturn]] void fail_here(const std::string& why) const {
    throw CloudFileError(fmt::format("{}:{}: {}", path_.string(), lines_.number(), why));
  }
  [[noreturn]] void contradicts() const { fail("its header contradicts itself, or the file's size"); }

  /// Index of the field of an axis: a single float or double.
  [[nodiscard]] std::size_t field_of(const Header& header, std::size_t axis) const {
    const auto found = std::ranges::find(header.fields, std::string(1, "xyz"[axis]), &Field::name);
    if (found == header.fields.end() || found->type != "F" || found->count != 1 ||
        (found->size != 4 && found->size != 8))
      fail("is not a pcd cloud with x y z of float or double");
    return static_cast<std::size_t>(found - header.fields.begin());
  }

  /// Bytes of the file that are not read yet.
  [[nodiscard]] std::uint64_t left() {
    const auto at = in_.tellg();
    return at < 0 ? 0 : size_ - std::min<std::uint64_t>(size_, static_cast<std::uint64_t>(at));
  }
  std::vector<char> take(std::uint64_t n) {
    std::vector<char> bytes(n);
    if (!in_.read(bytes.data(), static_cast<std::streamsize>(n))) fail("truncated");
    return bytes;
  }

  static std::vector<Eigen::Vector3f> points_of(const std::vector<char>& bytes, const std::array<Axis, 3>& axes,
                                                std::uint64_t n, const Eigen::Vector3d& origin) {
    std::vector<Eigen::Vector3f> points(n);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Axis& of = axes[axis];
      const auto k = static_cast<Eigen::Index>(axis);
      for (std::uint64_t i = 0; i < n; ++i) {
        const char* at = bytes.data() + of.begin + i * of.step;
        double value = 0;
        float single = 0;
        if (of.is_double) {
          std::memcpy(&value, at, sizeof value);
        } else {
          std::memcpy(&single, at, sizeof single);
          value = static_cast<double>(single);
        }
        points[i](k) = static_cast<float>(value - origin(k));
      }
    }
    return points;
  }

  std::filesystem::path path_;
  std::uintmax_t size_;  // bytes
  std::ifstream in_;
  TextLines lines_;
};

}  // namespace

std::vector<Eigen::Vector3f> read_pcd(const std::filesystem::path& path, const Eigen::Vector3d& origin) {
  PcdReader reader(path);
  const Header header = reader.read_header();
  if (header.data == "ascii") return reader.read_rows(header, origin);
  if (header.data == "binary") return reader.read_records(header, origin);
  if (header.data == "binary_compressed") return reader.read_compressed(header, origin);
  throw CloudFileError(fmt::format("{}: is not a pcd cloud: its points are \"{}\"", path.string(), header.data));
}

}  // namespace curbstone::detect
