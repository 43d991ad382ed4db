#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "common/bus/node.hpp"
#include "drivers/encoder/encoder_config.hpp"

namespace curbstone::encoder {

/// Names of the fault bits that are set: "over-voltage, encoder"; empty for 0. They are the same in object 603F (CAN)
/// and in registers 20A5 and 20A6 (Modbus) of a ZLAC8015D.
[[nodiscard]] std::string fault_text(std::uint16_t faults);
/// Adds a fault for each wheel whose bits are set. Index 0 is the left wheel.
void add_wheel_faults(NodeReport& report, const std::array<std::uint16_t, 2>& faults);
/// Adds a fault if the encoder lines that the drive reports (0: none) do not agree with the configured counts.
void add_encoder_lines_fault(NodeReport& report, std::uint32_t lines, const EncoderConfig& config);

}  // namespace curbstone::encoder
