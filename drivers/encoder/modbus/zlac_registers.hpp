#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

namespace curbstone::encoder::modbus {

/// Consecutive registers, read by one request of function 03. Addresses as on the wire.
struct Block {
  int address = 0;
  int count = 0;
};

// Feedback of a ZLAC8015D (RS485 Communication Instruction V1.06, 2023). The CAN objects with the same numbers differ.
inline constexpr Block kFaultsPositionsSpeeds{0x20A5, 8};
inline constexpr Block kPositionsSpeeds{0x20A7, 6};
inline constexpr Block kPositions{0x20A7, 4};
inline constexpr Block kFaults{0x20A5, 2};
inline constexpr Block kStatus{0x20A2, 1};
inline constexpr Block kStatusHallTemperature{0x20A2, 3};
inline constexpr Block kEncoderLines{0x2030, 1};  ///< of the left wheel's motor
inline constexpr int kMaxRegisters = 8;           ///< largest of the blocks above

/// Decodes two int32, each with its high word first, left before right. Index 0 is the left wheel.
[[nodiscard]] std::array<std::int32_t, 2> positions(std::span<const std::uint16_t, 4> registers);

/// Register 20A2, one byte per wheel: the two high bits are the wheel's state, the lowest bit says that it runs. The
/// manuals disagree on which byte is the left wheel's, so both bytes are treated alike, and the state is that of the
/// drive.
struct DriveState {
  bool enabled = false;         ///< both wheels are held or run; neither is stopped or in alarm
  bool emergency_stop = false;  ///< of either wheel
  bool alarm = false;           ///< of either wheel
};
[[nodiscard]] DriveState drive_state(std::uint16_t status);

}  // namespace curbstone::encoder::modbus
