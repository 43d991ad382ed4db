#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "drivers/lidar/packet/refusal.hpp"
#include "drivers/lidar/packet/rs16.hpp"

namespace curbstone::lidar::packet {

/// What a decoder needs to know of the device. The defaults are used until its first DIFOP packet.
struct DeviceInfo {
  double rpm = 0;                                  ///< as set; 0 = not known
  double fov = 360;                                ///< deg that it fires in; the rest of the turn is blind
  double distance_step = 0.005;                    ///< m; old firmware 0.01
  bool dual_return = false;                        ///< reports two returns a shot
  ElevationTable elevations = kNominalElevations;  ///< deg, by laser
  bool calibrated = false;                         ///< the elevations are the device's own

  bool operator==(const DeviceInfo&) const = default;
};

struct DifopResult {
  Refusal refusal = Refusal::kNone;
  DeviceInfo info;  ///< meaningless when refused
};

/// Reads a device information packet. Old units have a blank table of elevations (all 00 or all FF): the nominal one
/// stays. Any bytes may come. Source: RS-LiDAR-16 user manual, appendix B; ros_rslidar 726eacca.
[[nodiscard]] DifopResult parse_difop(std::span<const std::uint8_t> bytes);

}  // namespace curbstone::lidar::packet
