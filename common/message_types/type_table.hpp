#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/message_types/message_type.hpp"

namespace curbstone {

/// Message types by name and by fingerprint. Immutable once filled: any thread may look up.
class TypeTable {
 public:
  TypeTable() = default;
  TypeTable(TypeTable&&) = default;  // moving keeps the maps' nodes, into which the other map points
  TypeTable& operator=(TypeTable&&) = default;
  ~TypeTable() = default;

  /// The types of lcmtypes/: those of Curbstone's messages.
  [[nodiscard]] static const TypeTable& built_in();

  /// Adds the types of a .lcm file. Throws std::runtime_error: see parse_message_types().
  void add(std::string_view text);

  /// The type with this fingerprint; nullptr if there is none. A type with a member type that is not in the table has
  /// no fingerprint.
  [[nodiscard]] const MessageType* find(std::int64_t fingerprint) const;
  [[nodiscard]] const MessageType* find(const std::string& name) const;
  /// The fingerprint with which a message of this type begins; nothing if there is no such type.
  [[nodiscard]] std::optional<std::int64_t> fingerprint(const std::string& name) const;
  /// The type of a message, found by its first eight bytes.
  [[nodiscard]] const MessageType* type_of(const void* data, std::size_t size) const;

 private:
  void find_fingerprints();

  std::map<std::string, MessageType> by_name_;
  std::map<std::int64_t, const MessageType*> by_fingerprint_;
};

}  // namespace curbstone
