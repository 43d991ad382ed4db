#include "common/message_types/field_values.hpp"

#include <fmt/format.h>

#include <bit>
#include <cstdlib>
#include <span>
#include <type_traits>
#include <utility>

#include "common/bytes/big_endian.hpp"

namespace curbstone {

namespace {

constexpr int kDeepest = 20;  // messages within messages

class ValueDecoder {
 public:
  ValueDecoder(const TypeTable& table, std::span<const std::uint8_t> bytes, std::size_t most)
      : table_(table), bytes_(bytes), left_(most) {}

  [[nodiscard]] bool message(const MessageType& type, const std::string& prefix, int depth = 0) {
    if (depth > kDeepest) return false;
    std::vector<std::pair<std::string_view, std::int64_t>> lengths;  // integers of this message so far
    for (const MessageField& field : type.fields) {
      if (!array(field, 0, prefix + field.name, lengths, depth)) return false;
      const auto* number = values_.empty() ? nullptr : std::get_if<std::int64_t>(&values_.back().value);
      if (field.dimensions.empty() && number != nullptr) lengths.emplace_back(field.name, *number);
    }
    return true;
  }
  [[nodiscard]] bool at_end() const { return bytes_.empty(); }
  std::vector<NamedValue> take() { return std::move(values_); }

 private:
  using Lengths = std::vector<std::pair<std::string_view, std::int64_t>>;

  static std::int64_t length_of(const ArrayLength& length, const Lengths& lengths) {
    if (length.fixed) return std::strtoll(length.text.c_str(), nullptr, 10);
    for (const auto& [name, value] : lengths) {
      if (name == length.text) return value;
    }
    return -1;
  }

  bool array(const MessageField& field, std::size_t axis, const std::string& name, const Lengths& lengths, int depth) {
    if (axis == field.dimensions.size()) return element(field.type, name, depth);
    const std::int64_t length = length_of(field.dimensions[axis], lengths);
    if (length < 0) return false;
    for (std::int64_t i = 0; i < length; ++i) {
      // Elements without bytes (empty messages or arrays) count too: otherwise a length alone could cause unbounded
      // work.
      if (left_-- == 0) return false;
      if (!array(field, axis + 1, fmt::format("{}[{}]", name, i), lengths, depth)) return false;
    }
    return true;
  }

  bool element(const std::string& type, const std::string& name, int depth) {
    if (!is_primitive(type)) {
      const MessageType* held = table_.find(type);
      return held != nullptr && message(*held, name + ".", depth + 1);
    }
    auto value = primitive(type);
    if (!value) return false;
    values_.push_back({name, std::move(*value)});
    return true;
  }

  std::optional<FieldValue> primitive(const std::string& type) {
    if (type == "int8_t") return whole<std::uint8_t, std::int8_t>();
    if (type == "byte") return whole<std::uint8_t, std::uint8_t>();
    if (type == "int16_t") return whole<std::uint16_t, std::int16_t>();
    if (type == "int32_t") return whole<std::uint32_t, std::int32_t>();
    if (type == "int64_t") return whole<std::uint64_t, std::int64_t>();
    if (type == "float") return number<std::uint32_t>([](auto raw) { return FieldValue(std::bit_cast<float>(raw)); });
    if (type == "double") return number<std::uint64_t>([](auto raw) { return FieldValue(std::bit_cast<double>(raw)); });
    if (type == "boolean") return number<std::uint8_t>([](auto raw) { return FieldValue(raw != 0); });
    return text();
  }

  template <class Raw, class Number>
  std::optional<FieldValue> whole() {
    return number<Raw>([](Raw raw) { return FieldValue(static_cast<std::int64_t>(static_cast<Number>(raw))); });
  }
  template <class Raw, class Make>
  std::optional<FieldValue> number(Make make) {
    if (bytes_.size() < sizeof(Raw)) return std::nullopt;
    const Raw raw = read_big_endian<Raw>(bytes_);
    bytes_ = bytes_.subspan(sizeof(Raw));
    return make(raw);
  }
  /// Reads a text: its length, which includes the final NUL, and the characters.
  std::optional<FieldValue> text() {
    if (bytes_.size() < 4) return std::nullopt;
    const auto length = read_big_endian<std::uint32_t>(bytes_);
    if (length == 0 || length > bytes_.size() - 4) return std::nullopt;
    std::string value(reinterpret_cast<const char*>(bytes_.data()) + 4, length - 1);
    bytes_ = bytes_.subspan(4 + std::size_t{length});
    return FieldValue(std::move(value));
  }

  const TypeTable& table_;
  std::span<const std::uint8_t> bytes_;
  std::size_t left_;  // remaining array elements
  std::vector<NamedValue> values_;
};

}  // namespace

std::optional<std::vector<NamedValue>> decode_values(const TypeTable& table, const void* data, std::size_t size,
                                                     std::size_t most_values) {
  const MessageType* type = table.type_of(data, size);
  if (type == nullptr) return std::nullopt;
  ValueDecoder decoder(table, std::span(static_cast<const std::uint8_t*>(data), size).subspan(8), most_values);
  if (!decoder.message(*type, "") || !decoder.at_end()) return std::nullopt;
  return decoder.take();
}

std::string to_text(const FieldValue& value) {
  return std::visit(
      [](const auto& v) -> std::string {
        if constexpr (std::is_same_v<std::decay_t<decltype(v)>, std::string>) return v;
        return fmt::format("{}", v);
      },
      value);
}

}  // namespace curbstone
