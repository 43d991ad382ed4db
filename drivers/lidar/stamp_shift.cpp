#include "drivers/lidar/stamp_shift.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "common/bytes/big_endian.hpp"
#include "common/bytes/little_endian.hpp"
#include "drivers/lidar/models/robosense/packet_time.hpp"

namespace curbstone::lidar {

namespace {

using Bytes = std::span<std::uint8_t>;

constexpr std::size_t kRoboSenseSize = 1248;
constexpr std::size_t kRoboSenseStamp = 20;
constexpr std::array<std::uint8_t, 4> kRs16 = {0x55, 0xAA, 0x05, 0x0A};
constexpr std::array<std::uint8_t, 4> kHelios = {0x55, 0xAA, 0x05, 0x5A};
constexpr std::size_t kVlp16Size = 1206;
constexpr std::size_t kVlp16Stamp = 1200;  // us past the hour
constexpr std::int64_t kHour = 3'600'000'000;
constexpr std::int64_t kOneSecond = 1'000'000;

void shift_rs16(Bytes packet, std::int64_t shift) {
  models::robosense::PacketTime time;
  std::memcpy(&time, packet.data() + kRoboSenseStamp, sizeof time);
  const auto utime = models::robosense::utime_from(time);
  if (!utime) return;
  time = models::robosense::packet_time_from(*utime + shift);
  std::memcpy(packet.data() + kRoboSenseStamp, &time, sizeof time);
}

void shift_helios(Bytes packet, std::int64_t shift) {
  const Bytes field = packet.subspan(kRoboSenseStamp, 10);
  std::int64_t seconds = 0;
  for (std::size_t i = 0; i < 6; ++i) seconds = seconds << 8 | field[i];
  constexpr std::int64_t kEnd = std::int64_t{1} << 40;  // s: beyond any clock, and without overflow in us
  const auto fraction = std::int64_t{read_big_endian<std::uint32_t>(field.subspan(6))};
  if (seconds >= kEnd || fraction >= kOneSecond) return;
  const std::int64_t utime = seconds * kOneSecond + fraction + shift;
  for (std::size_t i = 0; i < 6; ++i) field[i] = static_cast<std::uint8_t>(utime / kOneSecond >> (8 * (5 - i)));
  for (std::size_t i = 0; i < 4; ++i) field[6 + i] = static_cast<std::uint8_t>(utime % kOneSecond >> (8 * (3 - i)));
}

void shift_vlp16(Bytes packet, std::int64_t shift) {
  const Bytes field = packet.subspan(kVlp16Stamp, 4);
  const std::int64_t past_hour = (read_little_endian<std::uint32_t>(field) + shift) % kHour;
  for (std::size_t i = 0; i < 4; ++i) field[i] = static_cast<std::uint8_t>(past_hour >> (8 * i));
}

bool begins_with(Bytes packet, const std::array<std::uint8_t, 4>& magic) {
  return std::equal(magic.begin(), magic.end(), packet.begin());
}

}  // namespace

void shift_stamp(Bytes packet, std::int64_t shift) {
  if (packet.size() == kVlp16Size) {
    shift_vlp16(packet, shift);
  } else if (packet.size() == kRoboSenseSize && begins_with(packet, kRs16)) {
    shift_rs16(packet, shift);
  } else if (packet.size() == kRoboSenseSize && begins_with(packet, kHelios)) {
    shift_helios(packet, shift);
  }
}

}  // namespace curbstone::lidar
