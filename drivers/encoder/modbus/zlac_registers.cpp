#include "drivers/encoder/modbus/zlac_registers.hpp"

namespace curbstone::encoder::modbus {

namespace {

enum class WheelState { kReleased = 0, kLocked = 1, kEmergencyStop = 2, kAlarm = 3 };

WheelState wheel_state(unsigned byte) {
  return static_cast<WheelState>(byte >> 6 & 3);
}

}  // namespace

std::array<std::int32_t, 2> positions(std::span<const std::uint16_t, 4> registers) {
  const auto whole = [](std::uint16_t high, std::uint16_t low) {
    return static_cast<std::int32_t>(std::uint32_t{high} << 16 | low);
  };
  return {whole(registers[0], registers[1]), whole(registers[2], registers[3])};
}

DriveState drive_state(std::uint16_t status) {
  DriveState state{true, false, false};
  for (const unsigned byte : {status & 0xFFu, static_cast<unsigned>(status) >> 8}) {
    const WheelState wheel = wheel_state(byte);
    const bool runs = (byte & 1) != 0;
    state.emergency_stop |= wheel == WheelState::kEmergencyStop;
    state.alarm |= wheel == WheelState::kAlarm;
    state.enabled &= wheel == WheelState::kLocked || (wheel == WheelState::kReleased && runs);
  }
  return state;
}

}  // namespace curbstone::encoder::modbus
