#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "common/bytes/big_endian.hpp"
#include "drivers/lidar/models/helios/helios.hpp"
#include "drivers/lidar/models/robosense/magic.hpp"

namespace curbstone::lidar::models::helios {

using Be48 = BigEndian<std::uint64_t, 6>;
using Be32 = BigEndian<std::uint32_t>;

struct MsopRecord {
  Be16 distance;  ///< in the packet's distance unit; 0 = no return
  std::uint8_t intensity = 0;
};

struct MsopBlock {
  static constexpr std::uint16_t kFlag = 0xFFEE;
  Be16 flag;
  Be16 azimuth;  ///< 0.01 deg, 0..35999, clockwise from above, of the block's first shot
  MsopRecord records[kRecords];
};

/// A point packet (MSOP) of a Helios.
struct MsopPacket {
  static constexpr std::uint8_t k5mm = 0;
  static constexpr std::uint8_t k2_5mm = 1;
  std::array<std::uint8_t, 4> magic;
  Be16 protocol;
  std::uint8_t reserved_6[2];
  Be32 top_count;
  Be32 bottom_count;
  std::uint8_t reserved_16;
  std::uint8_t distance_unit;
  std::uint8_t reserved_18[2];
  Be48 seconds;  ///< UTC, of the packet's first shot
  Be32 microseconds;
  std::uint8_t type[3];  ///< see base/sender.cpp
  std::uint8_t reserved_33[5];
  std::uint8_t temperature[2];
  std::uint8_t reserved_40[2];
  MsopBlock blocks[kBlocksPerPacket];
  std::uint8_t reserved_1242[4];
  std::array<std::uint8_t, 2> tail;
};
static_assert(sizeof(MsopPacket) == robosense::kPacketSize && alignof(MsopPacket) == 1);
static_assert(offsetof(MsopPacket, distance_unit) == 17 && offsetof(MsopPacket, seconds) == 20 &&
              offsetof(MsopPacket, type) == 30 && offsetof(MsopPacket, blocks) == 42 && sizeof(MsopBlock) == 100);

}  // namespace curbstone::lidar::models::helios
