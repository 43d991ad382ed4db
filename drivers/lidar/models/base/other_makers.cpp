#include "drivers/lidar/models/base/other_makers.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace curbstone::lidar::models {

namespace {

using Bytes = std::span<const std::uint8_t>;

std::size_t little16(Bytes bytes, std::size_t at) {
  return static_cast<std::size_t>(bytes[at]) | static_cast<std::size_t>(bytes[at + 1]) << 8;
}

/// Blocks of an azimuth and 3 or 4 bytes a laser.
bool holds_blocks(std::size_t size, std::size_t header, int lasers, int blocks) {
  constexpr std::size_t kMaxTail = 300;  // bytes: with its optional parts
  if (lasers < 16 || blocks < 1) return false;
  const auto body = static_cast<std::size_t>(blocks) * (2 + 3 * static_cast<std::size_t>(lasers));
  return size >= header + body && size <= header + 4 * body / 3 + 4 * static_cast<std::size_t>(blocks) + kMaxTail;
}

/// Hesai: EE FF, then a header with the numbers of lasers and blocks and the unit of distances, which is 4 mm in all of
/// them: 12 bytes (Pandar128, QT, XT, AT128), or 8 (Pandar64, Pandar20). The Pandar40P has FF EE before each of its
/// blocks of 124 bytes instead. Source: HesaiLidar_SDK_2.0 0e1da49, libhesai/UdpProtocol; HesaiLidar_General_SDK,
/// pandarGeneral_internal.h. Not named: FT120 and ET, whose headers have other fields.
bool is_hesai(Bytes bytes) {
  constexpr int kUnit = 4;  // mm
  constexpr std::size_t kTail64 = 22, kSequence = 4, kBlock40 = 124, kBlocks40 = 10;
  if (bytes.size() < 500) return false;
  if (bytes[0] == 0xEE && bytes[1] == 0xFF) {
    const bool versions = bytes[2] >= 1 && bytes[2] <= 7 && bytes[3] >= 1 && bytes[3] <= 8;
    if (versions && bytes[9] == kUnit && holds_blocks(bytes.size(), 12, bytes[6], bytes[7])) return true;
    const std::size_t whole = 8 + bytes[3] * (2 + 3 * static_cast<std::size_t>(bytes[2])) + kTail64;
    return bytes[5] == kUnit && bytes[2] >= 16 && (bytes.size() == whole || bytes.size() == whole + kSequence);
  }
  constexpr std::size_t kSize40 = kBlocks40 * kBlock40 + kTail64;
  if (bytes.size() != kSize40 && bytes.size() != kSize40 + kSequence) return false;
  for (std::size_t block = 0; block < kBlocks40; ++block) {
    if (bytes[kBlock40 * block] != 0xFF || bytes[kBlock40 * block + 1] != 0xEE) return false;
  }
  return true;
}

/// Livox: version 5, a type, and the length of a packet of that type (Mid-40, Mid-70, Horizon, Tele, Avia); or version
/// 0, its own length, and a number of points that agrees with it (HAP, Mid-360). Source: Livox-SDK, livox_def.h;
/// Livox-SDK2 08f523c, livox_lidar_def.h.
bool is_livox(Bytes bytes) {
  constexpr std::array<std::size_t, 9> kSizes = {1318, 918, 1362, 978, 1362, 786, 42, 1278, 678};  // by type
  if (bytes.size() < 42) return false;
  const std::size_t old_type = bytes[9];
  if (bytes[0] == 5 && bytes[3] == 0 && bytes[8] <= 5 && old_type < kSizes.size() && bytes.size() == kSizes[old_type])
    return true;
  constexpr std::size_t kHeader = 36;
  if (bytes[0] != 0 || little16(bytes, 1) != bytes.size()) return false;
  const std::size_t points = little16(bytes, 5);
  const auto holds = [&](std::size_t each) { return points >= 1 && bytes.size() == kHeader + points * each; };
  switch (bytes[10]) {
    case 0x00:  // IMU
      return bytes.size() == kHeader + 24;
    case 0x01:
      return holds(14);
    case 0x02:
      return holds(8);
    case 0x03:
      return holds(10);
    case 0x11:  // two returns
      return holds(28);
    default:
      return false;
  }
}

/// Ouster: 16 columns of all its lasers, numbered without a gap; a header of the packet, or (profile LEGACY) none.
/// Source: ouster_example 9d09711, ouster_client/src/parsing.cpp: sizes and offsets of each profile.
bool is_ouster(Bytes bytes) {
  constexpr std::size_t kColumns = 16, kNumber = 8;  // offset in a column
  const auto numbered = [&](std::size_t first, std::size_t column) {
    for (std::size_t i = 1; i < kColumns; ++i) {
      const std::size_t at = first + i * column + kNumber;
      if (little16(bytes, at) != little16(bytes, at - column) + 1) return false;
    }
    return true;
  };
  for (const std::size_t lasers : {16U, 32U, 64U, 128U}) {
    const std::size_t legacy = 16 + 12 * lasers + 4;
    if (bytes.size() == kColumns * legacy && numbered(0, legacy)) return true;
    for (const std::size_t each : {4U, 8U, 12U, 16U}) {
      constexpr std::size_t kHeader = 32, kFooter = 32;
      const std::size_t column = 12 + each * lasers;
      if (bytes.size() != kHeader + kColumns * column + kFooter) continue;
      if (little16(bytes, 0) == 1 && numbered(kHeader, column)) return true;
    }
  }
  return false;
}

}  // namespace

Sender other_maker_of(Bytes bytes) {
  if (is_hesai(bytes)) return Sender::kHesai;
  if (is_livox(bytes)) return Sender::kLivox;
  if (is_ouster(bytes)) return Sender::kOuster;
  return Sender::kUnknown;
}

}  // namespace curbstone::lidar::models
