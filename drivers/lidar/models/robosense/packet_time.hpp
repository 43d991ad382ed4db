#pragma once

#include <cstdint>
#include <optional>

#include "common/bytes/big_endian.hpp"

namespace curbstone::lidar::models::robosense {

/// Calendar time, UTC, as in RS16 packets ("YMD" format).
struct PacketTime {
  std::uint8_t year = 0;  ///< since 2000
  std::uint8_t month = 0;
  std::uint8_t day = 0;
  std::uint8_t hour = 0;
  std::uint8_t minute = 0;
  std::uint8_t second = 0;
  Be16 millisecond;
  Be16 microsecond;
};
static_assert(sizeof(PacketTime) == 10 && alignof(PacketTime) == 1);

/// us since the Unix epoch; nothing if a field is out of range. Independent of the host's time zone (rs_driver takes
/// the stamp as local time, which shifts it by the zone's offset).
[[nodiscard]] std::optional<std::int64_t> utime_from(const PacketTime& time);

/// Valid for the years 2000 to 2255.
[[nodiscard]] PacketTime packet_time_from(std::int64_t utime);

}  // namespace curbstone::lidar::models::robosense
