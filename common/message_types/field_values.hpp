#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "common/message_types/type_table.hpp"

namespace curbstone {

/// The value of a field. Integers of all widths, and byte, are std::int64_t.
using FieldValue = std::variant<std::int64_t, float, double, bool, std::string>;

/// One number or text of a message: "utime", "acceleration[2]", "lines[0].height[17]".
struct NamedValue {
  std::string name;
  FieldValue value;
};

/// Decodes the values of an encoded message in the order of its fields. Returns nothing if the table does not know its
/// fingerprint, or if the bytes are not exactly one message of that type: too short, too long, a negative length, or
/// more than `most_values` values.
[[nodiscard]] std::optional<std::vector<NamedValue>> decode_values(const TypeTable& table, const void* data,
                                                                   std::size_t size,
                                                                   std::size_t most_values = 1'000'000);

/// The value as text: the shortest decimal that reads back as the same number, true or false, or the text itself.
[[nodiscard]] std::string to_text(const FieldValue& value);

}  // namespace curbstone
