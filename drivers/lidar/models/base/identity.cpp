#include "drivers/lidar/models/base/identity.hpp"

#include <fmt/format.h>

#include "common/bus/levels.hpp"

namespace curbstone::lidar::models {

std::string to_text(const Identity& identity) {
  if (identity.serial_number.empty()) return "";
  std::string text = "serial number " + identity.serial_number;
  if (!identity.firmware.empty())
    text += fmt::format(", firmware {} (top) and {} (bottom)", identity.firmware, identity.bottom_firmware);
  return text;
}

void report(const Identity& identity, Counters& values) {
  set_text(values, "device.serial_number", identity.serial_number);
  set_text(values, "device.firmware", identity.firmware);
  set_text(values, "device.firmware_bottom", identity.bottom_firmware);
}

}  // namespace curbstone::lidar::models
