#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "drivers/lidar/packet/difop_packet.hpp"
#include "drivers/lidar/packet/msop_packet.hpp"
#include "tools/simulate/devices/rs16_emulator.hpp"

namespace curbstone::lidar {

/// A point packet without returns; blocks `step` (0.01 deg) apart from `azimuth` on.
inline packet::MsopPacket empty_packet(int azimuth = 0, int step = 40) {
  packet::MsopPacket packet{};
  packet.magic = packet::kMsopMagic;
  packet.time = packet::packet_time_from(1'700'000'000'000'000);
  for (int b = 0; b < packet::kBlocksPerPacket; ++b) {
    packet.blocks[b].flag = packet::MsopBlock::kFlag;
    packet.blocks[b].azimuth = static_cast<std::uint16_t>((azimuth + b * step) % 36000);
  }
  packet.tail = {0x00, 0xFF};
  return packet;
}

inline packet::Rs16Packet bytes_of(const packet::MsopPacket& packet) {
  return std::bit_cast<packet::Rs16Packet>(packet);
}

inline packet::DifopPacket info_packet() {
  return std::bit_cast<packet::DifopPacket>(simulate::devices::Rs16Emulator().difop(1'700'000'000'000'000, 1200));
}

/// Packets of an undisturbed device inside a sphere, one every 1332 us.
inline std::vector<packet::Rs16Packet> drive_packets(std::int64_t utime, int count, double rpm = 1200,
                                                     float range = 10.0F) {
  simulate::devices::Rs16Emulator emulator({.rpm = rpm});
  std::array<simulate::devices::Rs16Shot, packet::kLasers> shots;
  shots.fill({range, 100});
  std::vector<packet::Rs16Packet> packets;
  for (int i = 0; static_cast<int>(packets.size()) < count; ++i) {
    const auto at = utime + static_cast<std::int64_t>(i) * 111 / 2;
    if (const auto packet = emulator.add_sequence(at, i * emulator.azimuth_step(), shots)) packets.push_back(*packet);
  }
  return packets;
}

}  // namespace curbstone::lidar
