#pragma once

#include <exception>

namespace curbstone {

/// Decodes an encoded message into `message`, whose vectors keep their memory. Accepts any bytes. Returns false if the
/// bytes are not a message of this type; the content of `message` is then undefined.
template <class Message>
[[nodiscard]] bool decode(const void* data, int size, Message& message) {
  try {
    return message.decode(data, 0, size) >= 0;
  } catch (const std::exception&) {  // lcm-gen 1.3.1 throws length_error on a negative array length
    return false;
  }
}

}  // namespace curbstone
