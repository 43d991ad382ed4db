#pragma once

#include <sys/uio.h>

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

namespace curbstone::relay {

/// A datagram for sendmsg(), without a copy: its header, then a message as on the bus: channel, 0, data. The parts
/// point into the arguments, which must outlive the call.
inline std::array<iovec, 4> datagram_parts(std::span<const std::uint8_t> header, std::string_view channel,
                                           std::span<const std::uint8_t> data) {
  static constexpr char kEnd = 0;
  const auto part = [](const void* bytes, std::size_t size) { return iovec{const_cast<void*>(bytes), size}; };
  return {part(header.data(), header.size()), part(channel.data(), channel.size()), part(&kEnd, 1),
          part(data.data(), data.size())};
}

}  // namespace curbstone::relay
