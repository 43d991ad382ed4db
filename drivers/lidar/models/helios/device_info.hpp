#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "drivers/lidar/decoding/refusal.hpp"
#include "drivers/lidar/models/helios/helios.hpp"

namespace curbstone::lidar::models::helios {

/// What a decoder needs to know of a Helios.
struct DeviceInfo {
  int rpm = 0;          ///< as set
  int fov_start = 0;    ///< 0.01 deg: it fires clockwise from here ...
  int fov_end = 36000;  ///< ... to here
  bool dual_return = false;
  int lasers = 0;                              ///< that it tells the angles of; 0 = none
  std::array<LaserAngles, kRecords> angles{};  ///< by laser in firing order

  bool operator==(const DeviceInfo&) const = default;
};

/// How it is, for people.
struct DeviceStatus {
  int rpm = 0;
  bool pps_locked = false;
  bool gprmc_locked = false;
  int sync_mode = 0;    ///< 0 GPS, 1 PTP end to end, 2 peer to peer, 3 gPTP
  int sync_status = 0;  ///< 0 none, 1 GPS, 2 PTP
  std::string identity;
};

struct DifopResult {
  decoding::Refusal refusal = decoding::Refusal::kNone;
  DeviceInfo info;  ///< meaningless when refused
  DeviceStatus status;
};

/// Whether this is what a whole device says, where no second time confirms it: a speed that it can be set to and has,
/// and elevations that are spread as a Helios' are. An elevation that is off by more than half the distance of its
/// neighbours is noticed. One that is off by less, or an azimuth that is, cannot be.
[[nodiscard]] bool is_plausible(const DeviceInfo& info, const DeviceStatus& status);

/// Reads a Helios' device information. Any bytes may come. Source: RS-Helios-16P user manual; nebula 606ac41.
[[nodiscard]] DifopResult parse_difop(std::span<const std::uint8_t> bytes);

}  // namespace curbstone::lidar::models::helios
