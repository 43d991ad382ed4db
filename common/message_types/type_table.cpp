#include "common/message_types/type_table.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "common/bytes/big_endian.hpp"
#include "common/message_types/built_in_types.hpp"
#include "common/message_types/type_parser.hpp"

namespace curbstone {

namespace {

using Types = std::map<std::string, MessageType>;

/// lcmgen.c: hash_update(), hash_string_update(), lcm_struct_hash(). Arithmetic is modulo 2^64; shifts preserve the
/// sign.
class FieldHash {
 public:
  void add(std::uint8_t byte) {
    const std::uint64_t high = static_cast<std::uint64_t>(static_cast<std::int64_t>(value_) >> 55);
    value_ = ((value_ << 8) ^ high) + byte;
  }
  void add(std::string_view text) {
    add(static_cast<std::uint8_t>(text.size()));
    for (const char c : text) add(static_cast<std::uint8_t>(c));
  }
  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0x12345678;
};

std::uint64_t own_hash(const MessageType& type) {
  FieldHash hash;
  for (const MessageField& field : type.fields) {
    hash.add(field.name);
    if (is_primitive(field.type)) hash.add(field.type);
    hash.add(static_cast<std::uint8_t>(field.dimensions.size()));
    for (const ArrayLength& length : field.dimensions) {
      hash.add(static_cast<std::uint8_t>(length.fixed ? 0 : 1));
      hash.add(length.text);
    }
  }
  return hash.value();
}

/// The hash of a type with its member types. A type that contains itself counts once, as in lcm-gen. Nothing if a
/// member type is not known.
std::optional<std::uint64_t> recursive_hash(const Types& types, const MessageType& type,
                                            std::vector<const MessageType*>& parents) {
  if (std::find(parents.begin(), parents.end(), &type) != parents.end()) return 0;
  parents.push_back(&type);
  std::uint64_t sum = own_hash(type);
  for (const MessageField& field : type.fields) {
    if (is_primitive(field.type)) continue;
    const auto held = types.find(field.type);
    const auto hash = held == types.end() ? std::nullopt : recursive_hash(types, held->second, parents);
    if (!hash) return std::nullopt;
    sum += *hash;
  }
  parents.pop_back();
  return (sum << 1) | (sum >> 63);
}

TypeTable make_built_in() {
  TypeTable table;
  for (const std::string_view text : built_in_type_texts()) table.add(text);
  return table;
}

}  // namespace

const TypeTable& TypeTable::built_in() {
  static const TypeTable table = make_built_in();
  return table;
}

void TypeTable::add(std::string_view text) {
  for (MessageType& type : parse_message_types(text)) {
    std::string name = type.name;
    by_name_[std::move(name)] = std::move(type);
  }
  find_fingerprints();
}

void TypeTable::find_fingerprints() {
  by_fingerprint_.clear();
  for (const auto& [name, type] : by_name_) {
    std::vector<const MessageType*> parents;
    if (const auto hash = recursive_hash(by_name_, type, parents))
      by_fingerprint_[static_cast<std::int64_t>(*hash)] = &type;
  }
}

const MessageType* TypeTable::find(std::int64_t fingerprint) const {
  const auto it = by_fingerprint_.find(fingerprint);
  return it == by_fingerprint_.end() ? nullptr : it->second;
}

const MessageType* TypeTable::find(const std::string& name) const {
  const auto it = by_name_.find(name);
  return it == by_name_.end() ? nullptr : &it->second;
}

std::optional<std::int64_t> TypeTable::fingerprint(const std::string& name) const {
  for (const auto& [fingerprint, type] : by_fingerprint_) {
    if (type->name == name) return fingerprint;
  }
  return std::nullopt;
}

const MessageType* TypeTable::type_of(const void* data, std::size_t size) const {
  if (size < 8) return nullptr;
  const std::span bytes(static_cast<const std::uint8_t*>(data), size);
  return find(static_cast<std::int64_t>(read_big_endian<std::uint64_t>(bytes)));
}

}  // namespace curbstone
