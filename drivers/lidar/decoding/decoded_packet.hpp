#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "drivers/lidar/decoding/blind_zone.hpp"
#include "drivers/lidar/decoding/fired_packet.hpp"

namespace curbstone::lidar::decoding {

/// The returns of one point packet, in firing order. Frame: lidar (x forward, y left, z up). All vectors have one
/// element per return.
struct DecodedPacket {
  std::optional<std::int64_t> stamp;  ///< us since the Unix epoch on the device's clock, of the first shot; if valid
  int azimuth = 0;                    ///< 0.01 deg, clockwise, of the first shot
  double rate = 0;                    ///< 0.01 deg/s, rotation of the head
  double duration = 0;                ///< s from the first shot to the expected first shot of the next packet
  int out_of_range = 0;               ///< returns left out by their range
  int no_return = 0;                  ///< shots without a return
  std::optional<Gap> gap;             ///< a possible blind zone, if its azimuths were refused for it

  std::vector<float> x, y, z;      ///< m
  std::vector<float> time_offset;  ///< s after the first shot
  std::vector<std::uint8_t> intensity;
  std::vector<std::uint8_t> ring;  ///< rank by elevation, 0 = lowest

  FiredPacket fired;  ///< the data from which the points were made

  /// Begins a new packet. The vectors are kept: the decoder overwrites them.
  void begin() {
    stamp.reset();
    gap.reset();
    out_of_range = no_return = 0;
  }
};

}  // namespace curbstone::lidar::decoding
