#pragma once

#include <cstddef>
#include <cstdint>
#include <curbstone/lidar_points_t.hpp>

#include "drivers/lidar/decoding/fired_packet.hpp"

namespace curbstone::lidar {

/// What RecentMessages keeps of a LIDAR_POINTS message: what its points were made of, since they take four times the
/// memory.
struct SentPacket {
  std::int64_t utime = 0;  ///< as of the message
  std::int32_t packet = 0;
  std::int32_t revolution = 0;
  decoding::FiredPacket fired;

  [[nodiscard]] std::size_t bytes() const { return sizeof *this + fired.bytes(); }
  /// With every bit that it had.
  [[nodiscard]] lidar_points_t message() const;
};

}  // namespace curbstone::lidar
