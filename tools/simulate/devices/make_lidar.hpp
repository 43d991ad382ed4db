#pragma once

#include <memory>

#include "tools/simulate/devices/lidar_emulator.hpp"

namespace curbstone::simulate::devices {

enum class LidarName { kRs16, kVlp16, kHelios16p, kHelios32 };

/// A device with factory settings (strongest return), rotating at `rpm`.
[[nodiscard]] std::unique_ptr<LidarEmulator> make_lidar(LidarName name, double rpm);

}  // namespace curbstone::simulate::devices
