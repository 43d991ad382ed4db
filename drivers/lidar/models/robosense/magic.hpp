#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace curbstone::lidar::models::robosense {

inline constexpr std::size_t kPacketSize = 1248;  ///< bytes of UDP payload, of point packets and device information
using RawPacket = std::array<std::uint8_t, kPacketSize>;

inline constexpr int kMsopPort = 6699;   ///< point packets ("MSOP")
inline constexpr int kDifopPort = 7788;  ///< device information ("DIFOP")

using PacketMagic = std::array<std::uint8_t, 8>;
/// Of the point packets of an RS16, an RS32 and an RS-Bpearl.
inline constexpr PacketMagic kMsopMagic = {0x55, 0xAA, 0x05, 0x0A, 0x5A, 0xA5, 0x50, 0xA0};
/// Of the device information of all of these, and of the Helios.
inline constexpr PacketMagic kDifopMagic = {0xA5, 0xFF, 0x00, 0x5A, 0x11, 0x11, 0x55, 0x55};
/// Of a Helios's point packets.
inline constexpr std::array<std::uint8_t, 4> kHeliosMagic = {0x55, 0xAA, 0x05, 0x5A};

}  // namespace curbstone::lidar::models::robosense
