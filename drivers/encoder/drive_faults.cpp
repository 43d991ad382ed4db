#include "drivers/encoder/drive_faults.hpp"

#include <fmt/format.h>

#include <cmath>

namespace curbstone::encoder {

std::string fault_text(std::uint16_t faults) {
  static constexpr std::array<const char*, 16> kNames = {"over-voltage",
                                                         "under-voltage",
                                                         "over-current",
                                                         "overload",
                                                         "current tolerance",
                                                         "encoder tolerance",
                                                         "velocity tolerance",
                                                         "reference voltage",
                                                         "EEPROM",
                                                         "hall",
                                                         "motor temperature",
                                                         "encoder",
                                                         "bit 12",
                                                         "speed setting",
                                                         "bit 14",
                                                         "bit 15"};
  std::string text;
  for (std::size_t bit = 0; bit < kNames.size(); ++bit) {
    if ((faults >> bit & 1) != 0) text += (text.empty() ? "" : ", ") + std::string(kNames[bit]);
  }
  return text;
}

void add_wheel_faults(NodeReport& report, const std::array<std::uint16_t, 2>& faults) {
  for (std::size_t i = 0; i < 2; ++i) {
    if (const auto text = fault_text(faults[i]); !text.empty()) {
      report.faults.push_back(fmt::format("drive, {} wheel: {}", i == 0 ? "left" : "right", text));
    }
  }
}

void add_encoder_lines_fault(NodeReport& report, std::uint32_t lines, const EncoderConfig& config) {
  const double counts = 4.0 * lines;
  if (!config.check_encoder_lines || lines == 0 || std::abs(counts - config.counts_per_revolution) <= 0.5) return;
  report.faults.push_back(
      fmt::format("the drive has {} encoder lines, so {} counts a revolution, not {}: turn a wheel once and see", lines,
                  counts, config.counts_per_revolution));
}

}  // namespace curbstone::encoder
