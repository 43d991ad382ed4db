#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "drivers/lidar/decoding/refusal.hpp"
#include "drivers/lidar/models/base/identity.hpp"
#include "drivers/lidar/models/helios/helios.hpp"

namespace curbstone::lidar::models::helios {

/// Properties of a Helios that the decoder needs.
struct DeviceInfo {
  int rpm = 0;          ///< set speed
  int fov_start = 0;    ///< 0.01 deg: it fires clockwise from here ...
  int fov_end = 36000;  ///< ... to here
  bool dual_return = false;
  int lasers = 0;                              ///< number of lasers whose angles it reports; 0 = none
  std::array<LaserAngles, kRecords> angles{};  ///< by laser in firing order

  bool operator==(const DeviceInfo&) const = default;
};

/// State of the device, for the operator.
struct DeviceStatus {
  int rpm = 0;
  bool pps_locked = false;
  bool gprmc_locked = false;
  int sync_mode = 0;    ///< 0 GPS, 1 PTP end to end, 2 peer to peer, 3 gPTP
  int sync_status = 0;  ///< 0 none, 1 GPS, 2 PTP
  Identity identity;
};

struct DifopResult {
  decoding::Refusal refusal = decoding::Refusal::kNone;
  DeviceInfo info;  ///< undefined if refused
  DeviceStatus status;
};

/// Whether this is plausible for a device where no second packet confirms it: a speed that can be set and is reached,
/// and elevations that are spread as a Helios's are. An elevation that is wrong by more than half the distance to its
/// neighbours is detected. A smaller error, or a wrong azimuth, is not.
[[nodiscard]] bool is_plausible(const DeviceInfo& info, const DeviceStatus& status);

/// Parses a Helios's device information. Any bytes are allowed. Source: RS-Helios-16P user manual; nebula 606ac41.
[[nodiscard]] DifopResult parse_difop(std::span<const std::uint8_t> bytes);

}  // namespace curbstone::lidar::models::helios
