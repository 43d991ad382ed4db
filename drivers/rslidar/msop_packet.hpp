#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "drivers/rslidar/big_endian.hpp"
#include "drivers/rslidar/packet_time.hpp"
#include "drivers/rslidar/rs16.hpp"

namespace curbstone {

inline constexpr std::size_t kRs16PacketSize = 1248;  ///< bytes of UDP payload, of both kinds of packet
using Rs16Packet = std::array<std::uint8_t, kRs16PacketSize>;

inline constexpr int kMsopPort = 6699;
inline constexpr int kDifopPort = 7788;

using PacketMagic = std::array<std::uint8_t, 8>;
inline constexpr PacketMagic kMsopMagic = {0x55, 0xAA, 0x05, 0x0A, 0x5A, 0xA5, 0x50, 0xA0};
inline constexpr PacketMagic kDifopMagic = {0xA5, 0xFF, 0x00, 0x5A, 0x11, 0x11, 0x55, 0x55};

/// One shot of one laser.
struct MsopRecord {
  Be16 distance;  ///< 0.005 m (old firmware: 0.01 m); 0 = no return
  std::uint8_t intensity = 0;
};

/// Two firing sequences in a row, or one with two returns where the device is set to dual return.
struct MsopBlock {
  static constexpr std::uint16_t kFlag = 0xFFEE;
  Be16 flag;
  Be16 azimuth;  ///< 0.01 deg, 0..35999, clockwise from above, of the block's first shot
  MsopRecord records[kSequencesPerBlock * kLasers];
};

/// A point packet (MSOP). The device sends no checksum and no sequence number.
struct MsopPacket {
  PacketMagic magic;
  std::uint8_t reserved_8[12];
  PacketTime time;  ///< of the packet's first shot
  std::uint8_t reserved_30[8];
  std::uint8_t temperature[2];
  std::uint8_t reserved_40[2];
  MsopBlock blocks[kBlocksPerPacket];
  std::uint8_t reserved_1242[4];
  std::array<std::uint8_t, 2> tail;
};
static_assert(sizeof(MsopPacket) == kRs16PacketSize && alignof(MsopPacket) == 1);

/// A device information packet (DIFOP), about one a second.
struct DifopPacket {
  PacketMagic magic;
  Be16 rpm;  ///< as set: 300, 600, 1200
  std::uint8_t ethernet[22];
  Be16 fov_start;  ///< 0.01 deg
  Be16 fov_end;
  std::uint8_t reserved_36[2];
  Be16 phase_lock;                       ///< deg
  std::array<std::uint8_t, 5> firmware;  ///< of the top board
  std::array<std::uint8_t, 5> bottom_firmware;
  std::uint8_t reserved_50[242];
  std::uint8_t serial_number[6];
  std::uint8_t reserved_298[2];
  std::uint8_t return_mode;  ///< 0 dual, 1 strongest, 2 last
  std::uint8_t software_version[2];
  PacketTime time;
  std::uint8_t reserved_313[44];
  std::uint8_t gps_status;  ///< bit 0 PPS lock, bit 1 GPRMC lock, bit 2 UTC lock
  std::uint8_t reserved_358[807];
  Be24 elevation[kLasers];  ///< 0.0001 deg without sign: lasers 1..8 look down, 9..16 up
  std::uint8_t reserved_1213[33];
  std::array<std::uint8_t, 2> tail;
};
static_assert(sizeof(DifopPacket) == kRs16PacketSize && alignof(DifopPacket) == 1);
static_assert(offsetof(MsopPacket, time) == 20 && offsetof(MsopPacket, temperature) == 38 &&
              offsetof(MsopPacket, blocks) == 42 && sizeof(MsopBlock) == 100 && offsetof(MsopPacket, tail) == 1246);
static_assert(offsetof(DifopPacket, fov_start) == 32 && offsetof(DifopPacket, firmware) == 40 &&
              offsetof(DifopPacket, serial_number) == 292 && offsetof(DifopPacket, return_mode) == 300 &&
              offsetof(DifopPacket, time) == 303 && offsetof(DifopPacket, gps_status) == 357 &&
              offsetof(DifopPacket, elevation) == 1165 && offsetof(DifopPacket, tail) == 1246);

}  // namespace curbstone
