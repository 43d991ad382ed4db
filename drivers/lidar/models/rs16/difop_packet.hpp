#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "common/bytes/big_endian.hpp"
#include "drivers/lidar/models/robosense/magic.hpp"
#include "drivers/lidar/models/robosense/packet_time.hpp"
#include "drivers/lidar/models/rs16/rs16.hpp"

namespace curbstone::lidar::models::rs16 {

/// A device information packet (DIFOP), sent about once a second. Source: RS-LiDAR-16 user manual, appendix B.
struct DifopPacket {
  robosense::PacketMagic magic;
  Be16 rpm;  ///< set speed: 300, 600, 1200
  std::uint8_t ethernet[22];
  Be16 fov_start;  ///< 0.01 deg
  Be16 fov_end;
  std::uint8_t reserved_36[2];
  Be16 phase_lock;                       ///< deg
  std::array<std::uint8_t, 5> firmware;  ///< of the top board
  std::array<std::uint8_t, 5> bottom_firmware;
  std::uint8_t reserved_50[242];
  std::array<std::uint8_t, 6> serial_number;
  std::uint8_t reserved_298[2];
  std::uint8_t return_mode;  ///< 0 dual, 1 strongest, 2 last
  std::uint8_t software_version[2];
  robosense::PacketTime time;
  Be24 currents[2];              ///< uA, bit 23 is the sign
  std::array<Be16, 6> voltages;  ///< 4 bits of channel, 0 to 5, and 12 bits of 5 V: see device_info.cpp
  std::uint8_t reserved_331[26];
  std::uint8_t gps_status;  ///< bit 0 PPS lock, bit 1 GPRMC lock, bit 2 UTC lock
  std::array<Be16, 4> temperatures;
  std::uint8_t reserved_366[7];
  Be16 real_rpm;  ///< six times the speed
  std::uint8_t reserved_375[790];
  Be24 elevation[kLasers];  ///< 0.0001 deg without sign: lasers 1..8 point down, 9..16 up
  std::uint8_t reserved_1213[33];
  std::array<std::uint8_t, 2> tail;
};
static_assert(sizeof(DifopPacket) == robosense::kPacketSize && alignof(DifopPacket) == 1);
static_assert(offsetof(DifopPacket, fov_start) == 32 && offsetof(DifopPacket, firmware) == 40 &&
              offsetof(DifopPacket, serial_number) == 292 && offsetof(DifopPacket, return_mode) == 300 &&
              offsetof(DifopPacket, time) == 303 && offsetof(DifopPacket, voltages) == 319 &&
              offsetof(DifopPacket, gps_status) == 357 && offsetof(DifopPacket, real_rpm) == 373 &&
              offsetof(DifopPacket, elevation) == 1165 && offsetof(DifopPacket, tail) == 1246);

}  // namespace curbstone::lidar::models::rs16
