#pragma once

#include <limits>

#include "tools/simulate/devices/modbus_drive_emulator.hpp"
#include "tools/simulate/rig/emulated_wheels.hpp"
#include "tools/simulate/sensors/wheel_model.hpp"

namespace curbstone::simulate::rig {

/// The wheel drive on an RS485 line: it only responds to requests, after the time that request and reply take on the
/// wire at 115200 baud. The right wheel is mounted mirrored.
class EmulatedModbusWheels final : public WheelDevice {
 public:
  explicit EmulatedModbusWheels(sensors::WheelModel model) : model_(std::move(model)) {}

  Bytes power_on(std::int64_t) override { return {}; }
  Bytes on_bytes(std::int64_t now, std::span<const std::uint8_t> bytes) override;
  [[nodiscard]] std::int64_t next_due() const override { return due_; }
  Bytes run(std::int64_t now, double t) override;
  [[nodiscard]] std::int64_t messages() const override { return replies_; }

 private:
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

  sensors::WheelModel model_;
  devices::ModbusDriveEmulator drive_;
  std::int64_t due_ = kNever;
  Bytes reply_;
  std::int64_t replies_ = 0;
};

}  // namespace curbstone::simulate::rig
