#pragma once

#include <exception>

namespace curbstone {

/// Decodes an encoded message into `message`, whose vectors keep their memory. False for bytes that are no message of
/// this type: `message` means nothing then. Any bytes may come.
template <class Message>
[[nodiscard]] bool decode(const void* data, int size, Message& message) {
  try {
    return message.decode(data, 0, size) >= 0;
  } catch (const std::exception&) {  // lcm-gen 1.3.1 throws length_error on a negative array length
    return false;
  }
}

}  // namespace curbstone
