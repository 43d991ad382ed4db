#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace curbstone::relay {

/// A decoded datagram from one relay to another.
struct Frame {
  std::uint64_t run = 0;     ///< of the sender: differs after each of its starts
  std::uint32_t number = 0;  ///< counts up from 0 in a run, and wraps
  std::string_view channel;  ///< 1 to 63 bytes; empty in a heartbeat
  std::span<const std::uint8_t> data;
};

inline constexpr std::size_t kFrameHeader = 16;  ///< bytes: "CBR1", run, number; big-endian

[[nodiscard]] std::array<std::uint8_t, kFrameHeader> encode_frame_header(std::uint64_t run, std::uint32_t number);
/// Decodes a datagram. Returns nothing if it is not a frame: too short, another magic, or a channel that is empty, too
/// long or not terminated.
[[nodiscard]] std::optional<Frame> decode_frame(std::span<const std::uint8_t> datagram);

}  // namespace curbstone::relay
