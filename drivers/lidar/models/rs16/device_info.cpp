#include "drivers/lidar/models/rs16/device_info.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "common/bytes/big_endian.hpp"
#include "drivers/lidar/models/rs16/difop_packet.hpp"

namespace curbstone::lidar::models::rs16 {

using decoding::Refusal;

namespace {

/// Top-board firmware with distances in cm (ros_rslidar, rawdata.cc).
bool counts_in_centimetres(const std::array<std::uint8_t, 5>& firmware) {
  using Version = std::array<std::uint8_t, 3>;
  constexpr Version kOld[] = {{0x00, 0x00, 0x00}, {0xFF, 0xFF, 0xFF}, {0x55, 0xAA, 0x5A}, {0xE9, 0x01, 0x00}};
  return std::ranges::any_of(kOld,
                             [&](const Version& v) { return std::equal(v.begin(), v.end(), firmware.data() + 1); });
}

/// Older bottom boards do not set the return mode, and support only one return (ros_rslidar, rawdata.cc).
bool knows_return_mode(const std::array<std::uint8_t, 5>& bottom_firmware) {
  constexpr std::array<std::uint8_t, 3> kFirst = {0x08, 0x02, 0x09};
  return !std::lexicographical_compare(bottom_firmware.begin(), bottom_firmware.begin() + 3, kFirst.begin(),
                                       kFirst.end());
}

void read_field_of_view(const DifopPacket& packet, DeviceInfo& info) {
  if (packet.fov_start > 36000 || packet.fov_end > 36000) return;
  info.fov_start = packet.fov_start;
  info.fov_end = packet.fov_end;
}

/// 13 bits of 0.0625 deg C, and a sign (rs_driver 4eeadace, parseTempInLe; a recorded RS16 has the bytes swapped).
double celsius(std::uint16_t raw) {
  const double size = (raw & 0x7FFF) / 8 * 0.0625;
  return (raw & 0x8000) != 0 ? -size : size;
}

/// The manual has six voltages here, rs_driver's struct nine. A recorded RS16
/// (shared/data/rs16/rs16_washing_house.pcap) has six words and then zeros. Their upper four bits count from 0 to 5,
/// like the channel numbers of a converter. The lower twelve are a fraction of 5 V: the last four words are 4.95 V
/// (halved), 3.30, 2.56 and 1.21 V. The dividers of the two 12 V words are unknown. If the upper bits do not count like
/// that, nothing is reported.
std::array<int, 4> millivolts(const std::array<Be16, 6>& words) {
  std::array<int, 4> supplies{};
  for (std::size_t channel = 0; channel < words.size(); ++channel) {
    const std::uint16_t word = words[channel];
    if (word >> 12 != static_cast<int>(channel)) return {};
    constexpr std::size_t kFirst = 2;  // of those with a known divider
    if (channel >= kFirst) supplies[channel - kFirst] = (word & 0xFFF) * 5000 / 4096 * (channel == kFirst ? 2 : 1);
  }
  return supplies;
}

DeviceStatus status_of(const DifopPacket& packet) {
  DeviceStatus status;
  status.rpm = static_cast<int>(std::lround(packet.real_rpm / 6.0));  // manual, appendix B
  status.pps_locked = (packet.gps_status & 1) != 0;
  status.gprmc_locked = (packet.gps_status & 2) != 0;
  status.millivolts = millivolts(packet.voltages);
  std::ranges::transform(packet.temperatures, status.temperatures.begin(), celsius);
  const auto hex = [](const auto& bytes) { return fmt::format("{:02X}", fmt::join(bytes, "")); };
  status.identity = {hex(packet.serial_number), hex(packet.firmware), hex(packet.bottom_firmware)};
  return status;
}

bool blank(const Be24* table) {
  const std::uint8_t* bytes = table[0].bytes;
  return std::all_of(bytes, bytes + 4, [](std::uint8_t b) { return b == 0x00; }) ||
         std::all_of(bytes, bytes + 4, [](std::uint8_t b) { return b == 0xFF; });
}

/// Lasers 1..8 point down, 9..16 up: the sign is not transmitted.
bool read_elevations(const DifopPacket& packet, ElevationTable& elevations) {
  constexpr double kWorstMisalignment = 2.0;  // deg from nominal: more is another device, or noise
  for (std::size_t i = 0; i < kLasers; ++i) {
    const double size = packet.elevation[i] * 1e-4;
    elevations[i] = i < kLasers / 2 ? -size : size;
    if (std::abs(elevations[i] - kNominalElevations[i]) > kWorstMisalignment) return false;
  }
  return true;
}

}  // namespace

DifopResult parse_difop(std::span<const std::uint8_t> bytes) {
  if (bytes.size() != sizeof(DifopPacket)) return {Refusal::kLength, {}, {}};
  DifopPacket packet;
  std::memcpy(&packet, bytes.data(), sizeof packet);
  if (packet.magic != robosense::kDifopMagic) return {Refusal::kMagic, {}, {}};
  if (packet.return_mode > 2) return {Refusal::kDifopMode, {}, {}};

  DeviceInfo info;
  info.rpm = packet.rpm;
  read_field_of_view(packet, info);
  const bool old = counts_in_centimetres(packet.firmware);
  info.distance_step = old ? 0.01 : 0.005;
  if (old) info.times = kOldFiringTimes;
  info.dual_return = packet.return_mode == 0 && knows_return_mode(packet.bottom_firmware);
  info.calibrated = !blank(packet.elevation);
  if (info.calibrated && !read_elevations(packet, info.elevations)) return {Refusal::kDifopAngles, {}, {}};
  return {Refusal::kNone, info, status_of(packet)};
}

}  // namespace curbstone::lidar::models::rs16
