#include "drivers/lidar/models/helios/device_info.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "common/bytes/big_endian.hpp"
#include "drivers/lidar/models/robosense/magic.hpp"

namespace curbstone::lidar::models::helios {

using decoding::Refusal;
using Bytes = std::span<const std::uint8_t>;

namespace {

constexpr std::size_t kRpm = 8;
constexpr std::size_t kFovStart = 32;
constexpr std::size_t kFovEnd = 34;
constexpr std::size_t kTopFirmware = 40;  // 5 bytes; and so the bottom board's (nebula 07d898f, InfoPacketHelios)
constexpr std::size_t kBottomFirmware = 45;
constexpr std::size_t kSerialNumber = 292;  // 6 bytes
constexpr std::size_t kReturnMode = 300;    // 0 dual, 4 strongest, 5 last, 6 first
constexpr std::size_t kSyncMode = 301;
constexpr std::size_t kSyncStatus = 302;
constexpr std::size_t kRealRpm = 352;
constexpr std::size_t kGpsStatus = 359;   // bit 0 PPS, bit 1 GPRMC
constexpr std::size_t kElevations = 468;  // 32 x sign, u16 0.01 deg
constexpr std::size_t kAzimuths = 564;    // the same
constexpr double kSteepest = 90.0;        // deg
constexpr double kMaxBeside = 30.0;       // deg

int be16(Bytes bytes, std::size_t at) {
  return read_big_endian<std::uint16_t>(bytes.subspan(at));
}

/// Nothing if the entry is invalid: a sign that is neither 0 nor 1, or a magnitude above `most`.
std::optional<double> angle(Bytes bytes, std::size_t table, std::size_t laser, double most) {
  const std::size_t at = table + 3 * laser;
  const double size = be16(bytes, at + 1) * 0.01;
  if (bytes[at] > 1 || size > most) return std::nullopt;
  return bytes[at] == 1 ? -size : size;
}

/// Number of lasers with angles, if no two have the same direction: 32, 16, or 0.
int read_angles(Bytes bytes, std::array<LaserAngles, kRecords>& angles) {
  std::size_t lasers = 0;
  for (; lasers < kRecords; ++lasers) {
    const auto elevation = angle(bytes, kElevations, lasers, kSteepest);
    const auto azimuth = angle(bytes, kAzimuths, lasers, kMaxBeside);
    if (!elevation || !azimuth) break;
    const auto same = [&](const LaserAngles& other) { return other.elevation == *elevation; };
    if (std::any_of(angles.begin(), angles.begin() + static_cast<std::ptrdiff_t>(lasers), same)) break;
    angles[lasers] = {*elevation, *azimuth};
  }
  const std::size_t whole = lasers == kRecords ? kRecords : lasers >= kRecords / 2 ? kRecords / 2 : 0;
  std::fill(angles.begin() + static_cast<std::ptrdiff_t>(whole), angles.end(), LaserAngles{});
  return static_cast<int>(whole);
}

/// Elevations are evenly spread: each step is similar to its neighbours. Measured: steps of 1.3 to 4 deg, at most 1.55
/// times the larger neighbour, and at least 0.65 times the smaller.
bool are_spread_evenly(std::vector<double> elevations) {
  constexpr double kLow = -60, kHigh = 20;  // deg
  std::ranges::sort(elevations);
  if (elevations.front() < kLow || elevations.back() > kHigh) return false;
  std::vector<double> steps;
  for (std::size_t i = 1; i < elevations.size(); ++i) steps.push_back(elevations[i] - elevations[i - 1]);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const double before = steps[i > 0 ? i - 1 : 1];
    const double after = steps[i + 1 < steps.size() ? i + 1 : i - 1];
    if (steps[i] > 1.7 * std::max(before, after) || steps[i] < 0.55 * std::min(before, after)) return false;
  }
  return true;
}

}  // namespace

bool is_plausible(const DeviceInfo& info, const DeviceStatus& status) {
  constexpr double kMaxAzimuth = 10;  // deg
  const bool can_be_set = info.rpm == 300 || info.rpm == 600 || info.rpm == 1200;
  const bool has_it = std::abs(status.rpm - info.rpm) <= info.rpm / 10 || status.rpm == 0;
  if (!can_be_set || !has_it || info.lasers == 0) return false;
  std::vector<double> elevations;
  for (int i = 0; i < info.lasers; ++i) {
    const LaserAngles& laser = info.angles[static_cast<std::size_t>(i)];
    if (std::abs(laser.azimuth) > kMaxAzimuth) return false;
    elevations.push_back(laser.elevation);
  }
  return are_spread_evenly(std::move(elevations));
}

DifopResult parse_difop(Bytes bytes) {
  if (bytes.size() != robosense::kPacketSize) return {Refusal::kLength, {}, {}};
  if (!std::equal(robosense::kDifopMagic.begin(), robosense::kDifopMagic.end(), bytes.begin()))
    return {Refusal::kMagic, {}, {}};
  const int mode = bytes[kReturnMode];
  if (mode != 0 && (mode < 4 || mode > 6)) return {Refusal::kDifopMode, {}, {}};

  DifopResult result;
  result.info.rpm = be16(bytes, kRpm);
  if (be16(bytes, kFovStart) <= 36000 && be16(bytes, kFovEnd) <= 36000) {
    result.info.fov_start = be16(bytes, kFovStart);
    result.info.fov_end = be16(bytes, kFovEnd);
  }
  result.info.dual_return = mode == 0;
  result.info.lasers = read_angles(bytes, result.info.angles);
  result.status.rpm = be16(bytes, kRealRpm);
  result.status.pps_locked = (bytes[kGpsStatus] & 1) != 0;
  result.status.gprmc_locked = (bytes[kGpsStatus] & 2) != 0;
  result.status.sync_mode = bytes[kSyncMode];
  result.status.sync_status = bytes[kSyncStatus];
  const auto hex = [&](std::size_t at, std::size_t size) {
    return fmt::format("{:02X}", fmt::join(bytes.subspan(at, size), ""));
  };
  result.status.identity = {hex(kSerialNumber, 6), hex(kTopFirmware, 5), hex(kBottomFirmware, 5)};
  return result;
}

}  // namespace curbstone::lidar::models::helios
