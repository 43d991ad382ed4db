#include "tools/detect/pcd_file.hpp"

#include <fmt/format.h>
#include <pcl/PCLPointCloud2.h>
#include <pcl/console/print.h>
#include <pcl/conversions.h>
#include <pcl/io/pcd_io.h>
#include <pcl/point_types.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <set>
#include <string>

#include "tools/detect/cloud_file_error.hpp"
#include "tools/detect/text_rows.hpp"

namespace curbstone::detect {

namespace {

const std::set<std::string_view> kKeys = {"VERSION", "FIELDS", "SIZE",      "TYPE",   "COUNT",
                                          "WIDTH",   "HEIGHT", "VIEWPOINT", "POINTS", "DATA"};

struct Header {
  std::vector<std::string> fields;
  std::vector<std::string> types;
  std::vector<std::uint64_t> counts;  // numbers of each field; 1 if the file does not say
  std::uint64_t points = 0;
  std::string data;

  /// Index of the first number of a field in a row; nothing if there is no such field of single floats.
  [[nodiscard]] std::optional<std::size_t> column(std::string_view name) const {
    std::size_t column = 0;
    for (std::size_t i = 0; i < fields.size(); column += counts[i++]) {
      if (fields[i] == name) return types[i] == "F" && counts[i] == 1 ? std::optional(column) : std::nullopt;
    }
    return {};
  }
  [[nodiscard]] std::size_t columns() const {
    std::size_t columns = 0;
    for (const std::uint64_t count : counts) columns += count;
    return columns;
  }
};

class PcdReader {
 public:
  explicit PcdReader(const std::filesystem::path& path)
      : path_(path), size_(std::filesystem::file_size(path)), in_(path, std::ios::binary), lines_(in_) {}

  Header read_header() {
    constexpr int kMostLines = 1000;
    Header header;
    std::set<std::string, std::less<>> seen;
    while (header.data.empty() && lines_.number() < kMostLines && lines_.next()) {
      std::string_view rest = lines_.line();
      const std::string_view key = next_word(rest);
      if (key.empty() || key.starts_with('#')) continue;
      if (!kKeys.contains(key)) fail(fmt::format("is not a pcd cloud: line {} is none of its header", lines_.number()));
      seen.emplace(key);
      std::vector<std::string> words;
      for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) words.emplace_back(word);
      take(key, words, header);
    }
    for (const char* key : {"FIELDS", "SIZE", "TYPE", "WIDTH", "HEIGHT", "POINTS", "DATA"}) {
      if (!seen.contains(key)) fail(fmt::format("is not a pcd cloud: its header has no {}", key));
    }
    if (lines_.is_marked() && header.data != "ascii")
      fail("a byte order mark before binary points: PCL cannot read it");
    if (header.counts.empty()) header.counts.assign(header.fields.size(), 1);
    if (header.types.size() != header.fields.size() || header.counts.size() != header.fields.size())
      fail("its header contradicts itself");
    return header;
  }

  std::vector<Eigen::Vector3f> read_rows(const Header& header, const Eigen::Vector3d& origin) {
    std::array<std::size_t, 3> axes{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto column = header.column(std::string_view("xyz").substr(axis, 1));
      if (!column) fail("truncated, or not a pcd cloud with x y z of float or double");
      axes[axis] = *column;
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

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw CloudFileError(fmt::format("{}: {}", path_.string(), why));
  }
  [[noreturn]] void fail_here(const std::string& why) const {
    throw CloudFileError(fmt::format("{}:{}: {}", path_.string(), lines_.number(), why));
  }

  /// PCL crashes or allocates without bound on headers with false sizes.
  std::uint64_t plausible(const std::vector<std::string>& words, std::uint64_t most) const {
    const auto number = words.size() == 1 ? number_in<std::uint64_t>(words[0]) : std::nullopt;
    if (!number || *number > most) fail_here("is not a size that this file can have");
    return *number;
  }

  void take(std::string_view key, const std::vector<std::string>& words, Header& header) const {
    constexpr std::uint64_t kMostCounts = 100'000;
    const std::uint64_t most = 200 * size_;  // points, even compressed
    if (key == "FIELDS") header.fields = words;
    if (key == "TYPE") header.types = words;
    if (key == "WIDTH" || key == "HEIGHT") plausible(words, most);
    if (key == "POINTS") header.points = plausible(words, most);
    if (key == "DATA") header.data = words.empty() ? "none" : words[0];
    if (key == "COUNT") {
      for (const std::string& word : words) header.counts.push_back(plausible({word}, kMostCounts));
    }
  }

  std::filesystem::path path_;
  std::uintmax_t size_;  // bytes
  std::ifstream in_;
  TextLines lines_;
};

std::vector<Eigen::Vector3f> read_with_pcl(const std::filesystem::path& path, const Eigen::Vector3d& origin) {
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);  // it prints errors; this function throws instead
  pcl::PCLPointCloud2 blob;
  int result = -1;
  try {
    result = pcl::PCDReader().read(path.string(), blob);
  } catch (const std::exception&) {
    // reported below
  }
  const bool has_xyz = std::all_of(std::begin("xyz"), std::end("xyz") - 1, [&](char name) {
    return std::any_of(blob.fields.begin(), blob.fields.end(), [&](const pcl::PCLPointField& field) {
      return field.name == std::string(1, name) &&
             (field.datatype == pcl::PCLPointField::FLOAT32 || field.datatype == pcl::PCLPointField::FLOAT64);
    });
  });
  const std::size_t count = std::size_t{blob.width} * blob.height;
  if (result < 0 || !has_xyz || blob.point_step == 0 || blob.data.size() < count * blob.point_step)
    throw CloudFileError(fmt::format("{}: truncated, or not a pcd cloud with x y z of float or double", path.string()));
  std::vector<Eigen::Vector3f> points(count);
  for (const pcl::PCLPointField& field : blob.fields) {
    const std::size_t found = std::string("xyz").find(field.name);
    if (field.name.size() != 1 || found == std::string::npos) continue;
    const auto axis = static_cast<Eigen::Index>(found);
    const bool is_double = field.datatype == pcl::PCLPointField::FLOAT64;
    if (field.offset + (is_double ? 8 : 4) > blob.point_step)
      throw CloudFileError(fmt::format("{}: its header contradicts itself", path.string()));
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint8_t* at = &blob.data[i * blob.point_step + field.offset];
      double value = 0;
      float single = 0;
      if (is_double)
        std::memcpy(&value, at, sizeof value);
      else
        std::memcpy(&single, at, sizeof single);
      points[i](axis) = static_cast<float>((is_double ? value : static_cast<double>(single)) - origin(axis));
    }
  }
  return points;
}

}  // namespace

std::vector<Eigen::Vector3f> read_pcd(const std::filesystem::path& path, const Eigen::Vector3d& origin) {
  PcdReader reader(path);
  const Header header = reader.read_header();
  return header.data == "ascii" ? reader.read_rows(header, origin) : read_with_pcl(path, origin);
}

}  // namespace curbstone::detect
