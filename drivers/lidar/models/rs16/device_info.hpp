#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "drivers/lidar/decoding/refusal.hpp"
#include "drivers/lidar/models/base/identity.hpp"
#include "drivers/lidar/models/rs16/rs16.hpp"

namespace curbstone::lidar::models::rs16 {

/// Properties of the device that the decoder needs. The defaults are used until its first two DIFOP packets.
struct DeviceInfo {
  int rpm = 0;                                     ///< set speed; 0 = unknown
  int fov_start = 0;                               ///< 0.01 deg: it fires clockwise from here ...
  int fov_end = 36000;                             ///< ... to here
  double distance_step = 0.005;                    ///< m; old firmware 0.01
  FiringTimes times;                               ///< old firmware fires faster
  bool dual_return = false;                        ///< reports two returns per shot
  ElevationTable elevations = kNominalElevations;  ///< deg, by laser
  ElevationTable azimuths{};                       ///< deg relative to the head's azimuth: 0 unless from a file
  bool calibrated = false;                         ///< the elevations are reported by the device

  bool operator==(const DeviceInfo&) const = default;
};

/// State of the device, for the operator. Packets need not agree on it: temperatures and speeds vary.
struct DeviceStatus {
  int rpm = 0;                           ///< measured speed; 0 = not reported
  bool pps_locked = false;               ///< its clock follows a pulse per second
  bool gprmc_locked = false;             ///< and a GPS's sentence
  std::array<int, 4> millivolts{};       ///< of the supplies of 5, 3.3, 2.5 and 1.2 V; 0: not reported
  std::array<double, 4> temperatures{};  ///< deg C; the manual does not say which is which
  Identity identity;
};

struct DifopResult {
  decoding::Refusal refusal = decoding::Refusal::kNone;
  DeviceInfo info;  ///< undefined if refused
  DeviceStatus status;
};

/// Parses a device information packet. Old units have a blank table of elevations (all 00 or all FF): the nominal table
/// is used then. Any bytes are allowed. Source: RS-LiDAR-16 user manual, appendix B; ros_rslidar 726eacca.
[[nodiscard]] DifopResult parse_difop(std::span<const std::uint8_t> bytes);

}  // namespace curbstone::lidar::models::rs16
