#pragma once

#include <cstddef>
#include <cstdint>
#include <curbstone/lidar_points_t.hpp>

#include "drivers/lidar/decoding/fired_packet.hpp"

namespace curbstone::lidar {

/// The form in which RecentMessages keeps a LIDAR_POINTS message: the data from which its points were made, because the
/// points take four times the memory.
struct SentPacket {
  std::int64_t utime = 0;  ///< as of the message
  std::int32_t packet = 0;
  std::int32_t revolution = 0;
  decoding::FiredPacket fired;

  [[nodiscard]] std::size_t bytes() const { return sizeof *this + fired.bytes(); }
  /// The message, bit for bit.
  [[nodiscard]] lidar_points_t message() const;
};

}  // namespace curbstone::lidar
