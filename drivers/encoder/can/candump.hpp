#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "drivers/encoder/can/can_frame.hpp"

namespace curbstone::encoder::can {

/// One line of `candump -l`, "(1608055974.318981) can0 202#903C000000000000", or of what `candump -ta`, `-tA` or `-tz`
/// shows, " (1608055974.318981)  can0  202   [8]  90 3C 00 00 00 00 00 00".
struct CandumpLine {
  std::int64_t utime = 0;  ///< us; a date (-tA) is local time, and is taken as UTC
  std::string interface;
  CanFrame frame;
  bool other = false;  ///< an error frame, or CAN FD: `frame` is empty
};

/// Parses a line. Empty for anything that is not a line of a log: headings, broken lines.
[[nodiscard]] std::optional<CandumpLine> parse_candump_line(std::string_view line);

/// Whether this is a line as `candump` shows it without a time: "  can0  202   [2]  90 3C".
[[nodiscard]] bool is_candump_without_time(std::string_view line);

}  // namespace curbstone::encoder::can
