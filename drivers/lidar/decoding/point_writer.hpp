#pragma once

#include <cstdint>

#include "drivers/lidar/decoding/decoded_packet.hpp"

namespace curbstone::lidar::decoding {

/// One laser of a device, ready for use.
struct Laser {
  double cos = 1;  ///< of the elevation
  double sin = 0;
  double azimuth = 0;     ///< deg that it looks beside the head's azimuth, clockwise
  double height = 0;      ///< m above the origin
  std::uint8_t ring = 0;  ///< rank by elevation, 0 = lowest
};

/// Which returns go out.
struct ReturnLimits {
  double min_range = 0.4;  ///< m; nearer returns are left out
  double max_range = 150.0;
  double start_angle = 0.0;  ///< deg, clockwise: returns from here ...
  double end_angle = 360.0;  ///< ... to before here; equal, or 0 and 360: all
};

/// Turns a return into a point. Pure.
class PointWriter {
 public:
  /// `lens_offset`: m from the axis to the lenses, in the direction of the head's azimuth.
  PointWriter(const ReturnLimits& limits, double lens_offset);

  /// `azimuth_deg` of the head, of any turn; `time` s after the packet's first shot.
  void add(double azimuth_deg, double time, const Laser& laser, double range, std::uint8_t intensity,
           DecodedPacket& packet) const;

 private:
  [[nodiscard]] bool in_sector(double azimuth_deg) const;

  ReturnLimits limits_;
  double lens_offset_;
  bool whole_turn_;
};

}  // namespace curbstone::lidar::decoding
