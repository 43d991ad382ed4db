#include "common/resend/message_keeper.hpp"

#include <cstring>

namespace curbstone {

int EncodedMessage::encode(void* to, int offset, int max) const {
  if (offset < 0 || max < getEncodedSize()) return -1;
  std::memcpy(static_cast<std::uint8_t*>(to) + offset, encoded.data(), encoded.size());
  return getEncodedSize();
}

}  // namespace curbstone
