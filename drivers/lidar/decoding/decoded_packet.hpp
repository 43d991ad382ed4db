#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "drivers/lidar/decoding/blind_zone.hpp"
#include "drivers/lidar/decoding/fired_packet.hpp"

namespace curbstone::lidar::decoding {

/// The returns of one point packet, in the order in which they were fired. Frame: lidar (x forward, y left, z up). All
/// vectors have one element a return.
struct DecodedPacket {
  std::optional<std::int64_t> stamp;  ///< us since the Unix epoch on the device's clock, of the first shot; if sane
  int azimuth = 0;                    ///< 0.01 deg, clockwise, of the first shot
  double rate = 0;                    ///< 0.01 deg/s that the head turns
  double duration = 0;                ///< s from the first shot to when the next packet's is due
  int out_of_range = 0;               ///< returns that were left out
  int no_return = 0;                  ///< shots without one
  std::optional<Gap> gap;             ///< why its azimuths were refused, if it may be a blind zone

  std::vector<float> x, y, z;      ///< m
  std::vector<float> time_offset;  ///< s after the first shot
  std::vector<std::uint8_t> intensity;
  std::vector<std::uint8_t> ring;  ///< rank by elevation, 0 = lowest

  FiredPacket fired;  ///< what the points were made of

  /// Begins a new packet. The vectors stay as they are: who fills them overwrites them.
  void begin() {
    stamp.reset();
    gap.reset();
    out_of_range = no_return = 0;
  }
};

}  // namespace curbstone::lidar::decoding
