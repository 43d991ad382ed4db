#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include "drivers/lidar/lidar_config.hpp"
#include "drivers/lidar/models/helios/msop_packet.hpp"
#include "drivers/lidar/models/robosense/magic.hpp"

namespace curbstone::lidar::models::helios {

using Bytes = std::vector<std::uint8_t>;
constexpr std::int64_t kUtc = 1'700'000'000'000'000;

/// A point packet without returns, of a 16P by its newer type bytes.
inline MsopPacket points(int azimuth, int step, std::int64_t utime = kUtc) {
  MsopPacket packet{};
  packet.magic = robosense::kHeliosMagic;
  packet.distance_unit = MsopPacket::k2_5mm;
  packet.seconds = static_cast<std::uint64_t>(utime / 1'000'000);
  packet.microseconds = static_cast<std::uint32_t>(utime % 1'000'000);
  packet.type[1] = 0x06;
  packet.type[2] = 0x03;
  for (std::size_t b = 0; b < kBlocksPerPacket; ++b) {
    packet.blocks[b].flag = MsopBlock::kFlag;
    packet.blocks[b].azimuth = static_cast<std::uint16_t>((azimuth + static_cast<int>(b) * step) % 36000);
  }
  packet.tail = {0x00, 0xFF};
  return packet;
}
inline Bytes bytes_of(const MsopPacket& packet) {
  Bytes bytes(sizeof packet);
  std::memcpy(bytes.data(), &packet, sizeof packet);
  return bytes;
}

/// Device information with `lasers` angles: laser i looks 13 - i deg up and 1.5 - 0.1 i deg aside.
inline Bytes info(int lasers, std::uint8_t mode = 4) {
  Bytes bytes(robosense::kPacketSize);
  std::copy(robosense::kDifopMagic.begin(), robosense::kDifopMagic.end(), bytes.begin());
  const auto put = [&](std::size_t at, int value) {
    bytes[at] = static_cast<std::uint8_t>(value >> 8);
    bytes[at + 1] = static_cast<std::uint8_t>(value & 0xFF);
  };
  put(8, 600);
  put(34, 36000);
  put(352, 599);
  bytes[300] = mode;
  for (int i = 0; i < 32; ++i) {
    const auto at = 3 * static_cast<std::size_t>(i);
    const int elevation = i < lasers ? 1300 - 100 * (i - 1) : 0;
    const int azimuth = i < lasers ? 150 - 10 * (i - 1) : 0;
    bytes[468 + at] = static_cast<std::uint8_t>(i >= lasers ? 0xFF : elevation < 0 ? 1 : 0);
    put(469 + at, std::abs(elevation));
    bytes[564 + at] = static_cast<std::uint8_t>(i >= lasers ? 0xFF : azimuth < 0 ? 1 : 0);
    put(565 + at, std::abs(azimuth));
  }
  return bytes;
}

inline LidarConfig config_for(ModelName model) {
  LidarConfig config;
  config.model = model;
  return config;
}

}  // namespace curbstone::lidar::models::helios
