#pragma once

#include <string>

#include "tools/lidar_tool/packets.hpp"

namespace curbstone::lidar_tool {

/// Describes the packets: devices, models, ports, rates, losses, refusals, settings and clock of each device. `name`
/// heads the text. Reads the packets three times.
[[nodiscard]] std::string info_text(const Packets& packets, const std::string& name);

}  // namespace curbstone::lidar_tool
