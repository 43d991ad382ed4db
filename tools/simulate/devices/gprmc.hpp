#pragma once

#include <cstdint>
#include <string>

namespace curbstone::simulate::devices {

/// The sentence of a GPS with a fix, with checksum and line end, for the second of `utime` (us). The position is
/// arbitrary. Source: NMEA 0183, sentence RMC.
[[nodiscard]] std::string gprmc(std::int64_t utime);

}  // namespace curbstone::simulate::devices
