#pragma once

#include <string>

#include "common/bus/counters.hpp"

namespace curbstone::lidar::models {

/// Which device it is, as it reports itself: hexadecimal digits. Empty: not reported.
struct Identity {
  std::string serial_number;
  std::string firmware;         ///< of the top board
  std::string bottom_firmware;  ///< of the bottom board

  bool operator==(const Identity&) const = default;
};

/// "serial number 0033C1160BAAA, firmware 0623060A00 (top) and ... (bottom)"; empty if nothing is reported.
[[nodiscard]] std::string to_text(const Identity& identity);

/// The same as levels: "device.serial_number.0033C1160BAAA" is 1.
void report(const Identity& identity, Counters& values);

}  // namespace curbstone::lidar::models
