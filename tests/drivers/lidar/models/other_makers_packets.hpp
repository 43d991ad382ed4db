#pragma once

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

namespace curbstone::lidar::models {

using OtherPacket = std::vector<std::uint8_t>;

inline void put_at(OtherPacket& bytes, std::size_t at, std::initializer_list<int> values) {
  for (const int value : values) bytes[at++] = static_cast<std::uint8_t>(value);
}
inline void put_little16(OtherPacket& bytes, std::size_t at, std::size_t value) {
  put_at(bytes, at, {static_cast<int>(value & 0xFF), static_cast<int>(value >> 8 & 0xFF)});
}

/// XT-32: EE FF, version 6.1, 32 lasers, 8 blocks, unit 4 mm; 12 + 8 * (2 + 32 * 4) + 28 bytes.
inline OtherPacket hesai_xt_packet() {
  OtherPacket bytes(1080, 0x11);
  put_at(bytes, 0, {0xEE, 0xFF, 6, 1, 0, 0, 32, 8, 0, 4, 1, 0});
  return bytes;
}

/// A Mid-360 with 96 points of 14 bytes.
inline OtherPacket livox_packet() {
  OtherPacket bytes(36 + 96 * 14, 0x22);
  put_at(bytes, 0, {0});
  put_little16(bytes, 1, bytes.size());
  put_little16(bytes, 5, 96);
  put_at(bytes, 10, {1, 0});
  return bytes;
}

/// 16 columns from number 480 on; profile LEGACY (12 bytes a pixel) or one with a header.
inline OtherPacket ouster_packet(bool has_header, std::size_t lasers, std::size_t each) {
  const std::size_t column = has_header ? 12 + each * lasers : 16 + 12 * lasers + 4;
  OtherPacket bytes((has_header ? 64 : 0) + 16 * column, 0x33);
  if (has_header) put_little16(bytes, 0, 1);
  for (std::size_t i = 0; i < 16; ++i) put_little16(bytes, (has_header ? 32 : 0) + i * column + 8, 480 + i);
  return bytes;
}

/// By maker, a blank, and the model.
inline std::vector<std::pair<std::string, OtherPacket>> other_makers_packets() {
  std::vector<std::pair<std::string, OtherPacket>> packets = {{"hesai XT", hesai_xt_packet()},
                                                              {"livox Mid-360", livox_packet()}};
  // Pandar128, version 1.4: 128 lasers, 2 blocks of 2 + 128 * 3 bytes, then CRC, safety and tail.
  OtherPacket pandar128(893, 0x11);
  put_at(pandar128, 0, {0xEE, 0xFF, 1, 4, 0, 0, 128, 2, 1, 4, 2, 0x1F});
  packets.emplace_back("hesai 128", pandar128);
  // Pandar64: 64 lasers, 6 blocks; 8 + 6 * (2 + 64 * 3) + 22 bytes, and a number of 4 where it is set.
  for (const std::size_t size : {1194U, 1198U}) {
    OtherPacket pandar64(size, 0x11);
    put_at(pandar64, 0, {0xEE, 0xFF, 64, 6, 0, 4, 0, 0});
    packets.emplace_back("hesai 64", pandar64);
  }
  // Pandar40P: 10 blocks of FF EE, azimuth and 40 * 3 bytes; then 22 bytes, and a number of 4 where it is set.
  for (const std::size_t size : {1262U, 1266U}) {
    OtherPacket pandar40(size, 0x11);
    for (std::size_t block = 0; block < 10; ++block) put_at(pandar40, 124 * block, {0xFF, 0xEE});
    packets.emplace_back("hesai 40", pandar40);
  }
  // Livox before the HAP: version 5, its slot and number, reserved, status, time by PPS, type; a length for each type.
  const std::pair<int, std::size_t> old[] = {{0, 1318}, {1, 918}, {2, 1362}, {4, 1362}, {6, 42}, {7, 1278}};
  for (const auto& [type, size] : old) {
    OtherPacket bytes(size, 0x22);
    put_at(bytes, 0, {5, 1, 1, 0, 0, 0, 0, 0, 1, type});
    packets.emplace_back("livox of type " + std::to_string(type), bytes);
  }
  OtherPacket imu(60, 0x22);
  put_at(imu, 0, {0, 60, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1});
  packets.emplace_back("livox IMU", imu);
  // 6464, 12608 and 24896 bytes; then 24832, 33024 and 8448.
  for (const std::size_t lasers : {32U, 64U, 128U})
    packets.emplace_back("ouster LEGACY", ouster_packet(false, lasers, 12));
  packets.emplace_back("ouster RNG19_RFL8_SIG16_NIR16", ouster_packet(true, 128, 12));
  packets.emplace_back("ouster with two returns", ouster_packet(true, 128, 16));
  packets.emplace_back("ouster with little data", ouster_packet(true, 128, 4));
  return packets;
}

}  // namespace curbstone::lidar::models
