#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "common/bytes/big_endian.hpp"
#include "drivers/lidar/models/robosense/magic.hpp"
#include "drivers/lidar/models/robosense/packet_time.hpp"
#include "drivers/lidar/models/rs16/rs16.hpp"

namespace curbstone::lidar::models::rs16 {

/// One shot of one laser.
struct MsopRecord {
  Be16 distance;  ///< 0.005 m (old firmware: 0.01 m); 0 = no return
  std::uint8_t intensity = 0;
};

/// Two consecutive firing sequences, or one with two returns if the device is set to dual return.
struct MsopBlock {
  static constexpr std::uint16_t kFlag = 0xFFEE;
  Be16 flag;
  Be16 azimuth;  ///< 0.01 deg, 0..35999, clockwise from above, of the block's first shot
  MsopRecord records[kSequencesPerBlock * kLasers];
};

/// A point packet (MSOP). The device sends no checksum and no sequence number. Source: RS-LiDAR-16 user manual,
/// appendix A.
struct MsopPacket {
  robosense::PacketMagic magic;
  std::uint8_t reserved_8[12];
  robosense::PacketTime time;  ///< of the packet's first shot
  std::uint8_t reserved_30[8];
  std::uint8_t temperature[2];
  std::uint8_t reserved_40[2];
  MsopBlock blocks[kBlocksPerPacket];
  std::uint8_t reserved_1242[4];
  std::array<std::uint8_t, 2> tail;
};
static_assert(sizeof(MsopPacket) == robosense::kPacketSize && alignof(MsopPacket) == 1);
static_assert(offsetof(MsopPacket, time) == 20 && offsetof(MsopPacket, temperature) == 38 &&
              offsetof(MsopPacket, blocks) == 42 && sizeof(MsopBlock) == 100 && offsetof(MsopPacket, tail) == 1246);

}  // namespace curbstone::lidar::models::rs16
