#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "drivers/lidar/decoding/refusal.hpp"
#include "drivers/lidar/models/rs16/rs16.hpp"

namespace curbstone::lidar::models::rs16 {

/// What a decoder needs to know of the device. The defaults are used until its first two DIFOP packets.
struct DeviceInfo {
  int rpm = 0;                                     ///< as set; 0 = not known
  int fov_start = 0;                               ///< 0.01 deg: it fires clockwise from here ...
  int fov_end = 36000;                             ///< ... to here
  double distance_step = 0.005;                    ///< m; old firmware 0.01
  FiringTimes times;                               ///< old firmware fires faster
  bool dual_return = false;                        ///< reports two returns a shot
  ElevationTable elevations = kNominalElevations;  ///< deg, by laser
  ElevationTable azimuths{};                       ///< deg beside the head's azimuth: 0 but from a file
  bool calibrated = false;                         ///< the elevations are the device's own

  bool operator==(const DeviceInfo&) const = default;
};

/// How the device is, for people. Not in agreement from packet to packet: temperatures and speeds vary.
struct DeviceStatus {
  int rpm = 0;                           ///< as it turns; 0 = not reported
  bool pps_locked = false;               ///< its clock follows a pulse a second
  bool gprmc_locked = false;             ///< and a GPS's text
  std::array<int, 4> millivolts{};       ///< of the supplies of 5, 3.3, 2.5 and 1.2 V; 0: not reported
  std::array<double, 4> temperatures{};  ///< deg C; which is where the manual does not say
  std::string identity;                  ///< serial number and firmware
};

struct DifopResult {
  decoding::Refusal refusal = decoding::Refusal::kNone;
  DeviceInfo info;  ///< meaningless when refused
  DeviceStatus status;
};

/// Reads a device information packet. Old units have a blank table of elevations (all 00 or all FF): the nominal one
/// stays. Any bytes may come. Source: RS-LiDAR-16 user manual, appendix B; ros_rslidar 726eacca.
[[nodiscard]] DifopResult parse_difop(std::span<const std::uint8_t> bytes);

}  // namespace curbstone::lidar::models::rs16
