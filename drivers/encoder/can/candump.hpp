#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "drivers/encoder/can/can_frame.hpp"

namespace curbstone::encoder::can {

/// One line of `candump -l`: "(1608055974.318981) can0 202#903C000000000000".
struct CandumpLine {
  std::int64_t utime = 0;  ///< us
  std::string interface;
  CanFrame frame;
  bool other = false;  ///< an error frame, or CAN FD ("##"): `frame` is empty
};

/// Parses a line. Empty for anything that is not a line of a log: headings, broken lines.
[[nodiscard]] std::optional<CandumpLine> parse_candump_line(std::string_view line);

}  // namespace curbstone::encoder::can
