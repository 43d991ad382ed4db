#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace curbstone::simulate::devices {

/// A ZLAC8015D wheel drive seen from its RS485 line: a Modbus slave with the feedback registers. It supports only
/// function 03, because an emulated wheel must not be commanded; other functions return exception 01. A request with a
/// wrong checksum, or for another slave, is not answered. A byte stream state machine without a clock. Source: Modbus
/// over serial line V1.02; ZLAC8015D RS485 Communication Instruction V1.06.
class ModbusDriveEmulator {
 public:
  explicit ModbusDriveEmulator(std::uint8_t slave = 1) : slave_(slave) {}

  /// Takes bytes from the host. True if a request is complete: then answer() returns the reply, with the counts at that
  /// time.
  bool on_bytes(std::span<const std::uint8_t> bytes);
  [[nodiscard]] std::vector<std::uint8_t> answer();

  /// Encoder counts in the drive's convention (raw: the right wheel is mounted mirrored). They wrap as int32.
  void set_counts(std::int32_t left, std::int32_t right) { counts_ = {left, right}; }
  /// 0.1 rpm, raw.
  void set_speeds(std::int16_t left, std::int16_t right) { speeds_ = {left, right}; }
  void set_faults(std::uint16_t left, std::uint16_t right) { faults_ = {left, right}; }

 private:
  [[nodiscard]] std::optional<std::uint16_t> value(int address) const;

  std::uint8_t slave_;
  std::vector<std::uint8_t> request_;
  std::array<std::int32_t, 2> counts_{};
  std::array<std::int16_t, 2> speeds_{};
  std::array<std::uint16_t, 2> faults_{};
};

/// The checksum of a Modbus frame on a serial line; its low byte goes first.
[[nodiscard]] std::uint16_t modbus_crc(std::span<const std::uint8_t> bytes);

}  // namespace curbstone::simulate::devices
