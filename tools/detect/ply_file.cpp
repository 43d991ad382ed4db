#include "tools/detect/ply_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <string>

#include "tools/detect/cloud_file_error.hpp"
#include "tools/detect/text_rows.hpp"

namespace curbstone::detect {

namespace {

static_assert(std::endian::native == std::endian::little, "binary_little_endian is copied as it is");

struct Type {
  std::size_t size = 0;  // bytes
  bool is_float = false;
  bool is_signed = false;
};
const std::map<std::string_view, Type> kTypes = {
    {"char", {1, false, true}},    {"int8", {1, false, true}},    {"uchar", {1, false, false}},
    {"uint8", {1, false, false}},  {"short", {2, false, true}},   {"int16", {2, false, true}},
    {"ushort", {2, false, false}}, {"uint16", {2, false, false}}, {"int", {4, false, true}},
    {"int32", {4, false, true}},   {"uint", {4, false, false}},   {"uint32", {4, false, false}},
    {"float", {4, true, true}},    {"float32", {4, true, true}},  {"double", {8, true, true}},
    {"float64", {8, true, true}},
};

struct Property {
  std::string name;
  Type type;
  std::size_t count_size = 0;  // of a list's count, bytes; 0: no list
};
struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};
enum class Format { kNone, kAscii, kLittle, kBig };

class PlyReader {
 public:
  PlyReader(const std::filesystem::path& path, const Eigen::Vector3d& origin)
      : path_(path),
        origin_(origin),
        size_(std::filesystem::file_size(path)),
        in_(path, std::ios::binary),
        lines_(in_) {}

  std::vector<Eigen::Vector3f> read() {
    read_header();
    for (const Element& element : elements_) {
      if (element.name == "vertex") {
        find_axes(element);
        return format_ == Format::kAscii ? read_rows(element) : read_records(element);
      }
      skip(element);
    }
    fail("has no vertices");
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw CloudFileError(fmt::format("{}: {}", path_.string(), why));
  }
  [[noreturn]] void fail_here(const std::string& why) const {
    throw CloudFileError(fmt::format("{}:{}: {}", path_.string(), lines_.number(), why));
  }

  void read_header() {
    constexpr int kMaxLines = 1000;
    if (!lines_.next()) fail("is not a ply cloud");
    std::string_view first = lines_.line();
    if (next_word(first) != "ply") fail("is not a ply cloud");
    while (lines_.number() < kMaxLines && lines_.next()) {
      std::string_view rest = lines_.line();
      const std::string_view key = next_word(rest);
      if (key == "end_header") {
        if (format_ == Format::kNone) fail("is not a ply cloud: it names no format");
        return;
      }
      if (key.empty() || key == "comment" || key == "obj_info") continue;
      if (key == "format") {
        const std::string_view name = next_word(rest);
        format_ = name == "ascii"                  ? Format::kAscii
                  : name == "binary_little_endian" ? Format::kLittle
                  : name == "binary_big_endian"    ? Format::kBig
                                                   : Format::kNone;
        if (format_ == Format::kNone) fail_here("a format that is not known");
      } else if (key == "element") {
        const std::string name(next_word(rest));
        const auto count = number_in<std::uint64_t>(next_word(rest));
        if (!count || *count > size_) fail_here(fmt::format("more of \"{}\" than the file can hold", name));
        elements_.push_back({name, *count, {}});
      } else if (key == "property" && !elements_.empty()) {
        elements_.back().properties.push_back(property(rest));
      } else {
        fail_here("is not a line of a ply header");
      }
    }
    fail("is not a ply cloud: its header has no end");
  }

  Property property(std::string_view rest) const {
    Property property;
    std::string_view type = next_word(rest);
    if (type == "list") {
      const auto count = kTypes.find(next_word(rest));
      if (count == kTypes.end() || count->second.is_float) fail_here("a list of an unknown type");
      property.count_size = count->second.size;
      type = next_word(rest);
    }
    const auto found = kTypes.find(type);
    property.name = next_word(rest);
    if (found == kTypes.end() || property.name.empty()) fail_here("a property of an unknown type");
    property.type = found->second;
    return property;
  }

  void find_axes(const Element& vertex) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::string name(1, "xyz"[axis]);
      const auto found = std::ranges::find(vertex.properties, name, &Property::name);
      if (found == vertex.properties.end() || found->count_size != 0 || !found->type.is_float)
        fail("its vertices have no x y z of float or double");
      axes_[axis] = static_cast<std::size_t>(found - vertex.properties.begin());
    }
  }

  [[nodiscard]] Eigen::Vector3f point(const std::vector<double>& values) const {
    return (Eigen::Vector3d(values[axes_[0]], values[axes_[1]], values[axes_[2]]) - origin_).cast<float>();
  }

  /// The next line that is not blank.
  bool next_row() {
    while (lines_.next()) {
      if (lines_.line().find_first_not_of(" \t\r") != std::string_view::npos) return true;
    }
    return false;
  }

  std::vector<Eigen::Vector3f> read_rows(const Element& vertex) {
    std::vector<Eigen::Vector3f> points;
    std::vector<double> values(vertex.properties.size());
    for (std::uint64_t i = 0; i < vertex.count; ++i) {
      if (!next_row()) fail(fmt::format("truncated: {} of {} vertices", i, vertex.count));
      std::string_view rest = lines_.line();
      for (std::size_t k = 0; k < values.size(); ++k) {
        const std::string_view word = next_word(rest);
        const auto value = number_in(word);
        if (!value)
          fail_here(word.empty() ? "too few numbers" : fmt::format("\"{}\" is no number", word.substr(0, 20)));
        values[k] = *value;
        for (double left = vertex.properties[k].count_size != 0 ? *value : 0; left > 0; --left) {
          if (next_word(rest).empty()) fail_here("too few numbers");
        }
      }
      if (!next_word(rest).empty()) fail_here("more numbers than properties");
      points.push_back(point(values));
    }
    return points;
  }

  /// The next bytes, as a number in this machine's order.
  double number(const Type& type) {
    std::array<char, 8> bytes{};
    if (!in_.read(bytes.data(), static_cast<std::streamsize>(type.size))) fail("truncated");
    if (format_ == Format::kBig) std::reverse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(type.size));
    const auto as = [&bytes]<class Number>(Number number) {
      std::memcpy(&number, bytes.data(), sizeof number);
      return static_cast<double>(number);
    };
    if (type.is_float) return type.size == 4 ? as(float{}) : as(double{});
    switch (type.size) {
      case 1:
        return type.is_signed ? as(std::int8_t{}) : as(std::uint8_t{});
      case 2:
        return type.is_signed ? as(std::int16_t{}) : as(std::uint16_t{});
      default:
        return type.is_signed ? as(std::int32_t{}) : as(std::uint32_t{});
    }
  }

  /// Reads one record, its lists without their content.
  void read_record(const Element& element, std::vector<double>& values) {
    for (std::size_t k = 0; k < element.properties.size(); ++k) {
      const Property& property = element.properties[k];
      if (property.count_size == 0) {
        values[k] = number(property.type);
        continue;
      }
      const double count = number({property.count_size, false, false});
      const double bytes = count * static_cast<double>(property.type.size);
      if (bytes > static_cast<double>(size_)) fail("truncated");
      in_.ignore(static_cast<std::streamsize>(bytes));
    }
  }

  std::vector<Eigen::Vector3f> read_records(const Element& vertex) {
    std::vector<Eigen::Vector3f> points;
    std::vector<double> values(vertex.properties.size());
    for (std::uint64_t i = 0; i < vertex.count; ++i) {
      read_record(vertex, values);
      points.push_back(point(values));
    }
    return points;
  }

  void skip(const Element& element) {
    std::vector<double> values(element.properties.size());
    for (std::uint64_t i = 0; i < element.count; ++i) {
      if (format_ != Format::kAscii) {
        read_record(element, values);
      } else if (!next_row()) {
        fail("truncated");
      }
    }
  }

  std::filesystem::path path_;
  Eigen::Vector3d origin_;
  std::uintmax_t size_;  // bytes
  std::ifstream in_;
  TextLines lines_;
  Format format_ = Format::kNone;
  std::vector<Element> elements_;
  std::array<std::size_t, 3> axes_{};  // properties of the vertices
};

}  // namespace

std::vector<Eigen::Vector3f> read_ply(const std::filesystem::path& path, const Eigen::Vector3d& origin) {
  return PlyReader(path, origin).read();
}

}  // namespace curbstone::detect
