#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace curbstone::lidar::packet {

inline constexpr std::size_t kRs16PacketSize = 1248;  ///< bytes of UDP payload, of both kinds of packet
using Rs16Packet = std::array<std::uint8_t, kRs16PacketSize>;

inline constexpr int kMsopPort = 6699;
inline constexpr int kDifopPort = 7788;

using PacketMagic = std::array<std::uint8_t, 8>;
inline constexpr PacketMagic kMsopMagic = {0x55, 0xAA, 0x05, 0x0A, 0x5A, 0xA5, 0x50, 0xA0};
inline constexpr PacketMagic kDifopMagic = {0xA5, 0xFF, 0x00, 0x5A, 0x11, 0x11, 0x55, 0x55};

}  // namespace curbstone::lidar::packet
