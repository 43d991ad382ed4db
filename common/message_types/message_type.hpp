#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace curbstone {

/// The length of an array along one axis: a number, or an earlier field of the same message.
struct ArrayLength {
  std::string text;   ///< as written: "36" or "num_points"
  bool fixed = true;  ///< `text` is a number
};

struct MessageField {
  std::string name;
  std::string type;  ///< a primitive type, "double", or the full name of another message, "curbstone.curb_line_t"
  std::vector<ArrayLength> dimensions;
};

/// A message type as its .lcm file defines it. Constants are left out: they are not part of a message.
struct MessageType {
  std::string name;  ///< with its package: "curbstone.imu_t"
  std::vector<MessageField> fields;
};

/// Whether the type is int8_t, int16_t, int32_t, int64_t, byte, float, double, string or boolean: all of LCM's
/// primitives.
[[nodiscard]] bool is_primitive(const std::string& type);

}  // namespace curbstone
