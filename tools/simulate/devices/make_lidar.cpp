#include "tools/simulate/devices/make_lidar.hpp"

#include "tools/simulate/devices/helios_emulator.hpp"
#include "tools/simulate/devices/rs16_emulator.hpp"
#include "tools/simulate/devices/vlp16_emulator.hpp"

namespace curbstone::simulate::devices {

std::unique_ptr<LidarEmulator> make_lidar(LidarName name, double rpm) {
  switch (name) {
    case LidarName::kVlp16:
      return std::make_unique<Vlp16Emulator>(Vlp16EmulatorConfig{.rpm = rpm});
    case LidarName::kHelios16p:
      return std::make_unique<HeliosEmulator>(
          HeliosEmulatorConfig{.lasers = 16, .rpm = rpm, .mode = ReturnMode::kStrongest, .angles = {}});
    case LidarName::kHelios32:
      return std::make_unique<HeliosEmulator>(
          HeliosEmulatorConfig{.lasers = 32, .rpm = rpm, .mode = ReturnMode::kStrongest, .angles = {}});
    case LidarName::kRs16:
      break;
  }
  Rs16EmulatorConfig config;
  config.rpm = rpm;
  return std::make_unique<Rs16Emulator>(config);
}

}  // namespace curbstone::simulate::devices
