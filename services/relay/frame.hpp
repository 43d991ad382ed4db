#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace curbstone::relay {

/// A datagram from one relay to another, taken apart.
struct Frame {
  std::uint64_t run = 0;     ///< of the sender: another one after each of its starts
  std::uint32_t number = 0;  ///< counts up from 0 in a run, and around
  std::string_view channel;  ///< 1 to 63 bytes; empty in a sign of life
  std::span<const std::uint8_t> data;
};

inline constexpr std::size_t kFrameHeader = 16;  ///< bytes: "CBR1", run, number; big-endian

[[nodiscard]] std::array<std::uint8_t, kFrameHeader> encode_frame_header(std::uint64_t run, std::uint32_t number);
/// Nothing when it is none: too short, another magic, a channel that is unnamed, too long or not terminated.
[[nodiscard]] std::optional<Frame> decode_frame(std::span<const std::uint8_t> datagram);

}  // namespace curbstone::relay
