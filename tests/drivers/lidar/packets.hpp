#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "drivers/lidar/models/rs16/difop_packet.hpp"
#include "drivers/lidar/models/rs16/msop_packet.hpp"
#include "tools/simulate/devices/rs16_emulator.hpp"

namespace curbstone::lidar {

/// A point packet without returns; blocks `step` (0.01 deg) apart from `azimuth` on.
inline models::rs16::MsopPacket empty_packet(int azimuth = 0, int step = 40) {
  models::rs16::MsopPacket packet{};
  packet.magic = models::robosense::kMsopMagic;
  packet.time = models::robosense::packet_time_from(1'700'000'000'000'000);
  for (int b = 0; b < models::rs16::kBlocksPerPacket; ++b) {
    packet.blocks[b].flag = models::rs16::MsopBlock::kFlag;
    packet.blocks[b].azimuth = static_cast<std::uint16_t>((azimuth + b * step) % 36000);
  }
  packet.tail = {0x00, 0xFF};
  return packet;
}

inline models::rs16::Rs16Packet bytes_of(const models::rs16::MsopPacket& packet) {
  return std::bit_cast<models::rs16::Rs16Packet>(packet);
}

inline models::rs16::DifopPacket info_packet() {
  return std::bit_cast<models::rs16::DifopPacket>(simulate::devices::Rs16Emulator().difop(1'700'000'000'000'000, 1200));
}

/// Packets of an undisturbed device inside a sphere, one every 1332 us.
inline std::vector<models::rs16::Rs16Packet> drive_packets(std::int64_t utime, int count, double rpm = 1200,
                                                           float range = 10.0F) {
  simulate::devices::Rs16Emulator emulator({.rpm = rpm});
  std::array<simulate::devices::LidarShot, models::rs16::kLasers> shots;
  shots.fill({range, 100});
  std::vector<models::rs16::Rs16Packet> packets;
  for (int i = 0; static_cast<int>(packets.size()) < count; ++i) {
    const auto at = utime + static_cast<std::int64_t>(i) * 111 / 2;
    if (const auto packet = emulator.add_sequence(at, i * emulator.azimuth_step(), shots)) packets.push_back(*packet);
  }
  return packets;
}

}  // namespace curbstone::lidar
