#pragma once

#include "tools/simulate/devices/can_drive_emulator.hpp"
#include "tools/simulate/devices/slcan_emulator.hpp"
#include "tools/simulate/rig/serial_device.hpp"
#include "tools/simulate/sensors/wheel_model.hpp"

namespace curbstone::simulate::rig {

/// The wheel drive, on any line.
class WheelDevice : public SerialDevice {
 public:
  /// Number of messages for the host: frames, or replies.
  [[nodiscard]] virtual std::int64_t messages() const = 0;

 protected:
  /// rad/s to 0.1 rpm, the drive's unit
  [[nodiscard]] static std::int16_t decirpm(double speed);
};

/// The wheel drive on its CAN bus, behind a serial SLCAN adapter. The right wheel is mounted mirrored.
class EmulatedWheels final : public WheelDevice {
 public:
  explicit EmulatedWheels(sensors::WheelModel model);

  Bytes power_on(std::int64_t now) override;
  Bytes on_bytes(std::int64_t now, std::span<const std::uint8_t> bytes) override;
  [[nodiscard]] std::int64_t next_due() const override;
  Bytes run(std::int64_t now, double t) override;
  [[nodiscard]] std::int64_t messages() const override { return frames_; }

 private:
  Bytes to_host(const devices::CanDriveEmulator::Frames& frames);

  sensors::WheelModel model_;
  devices::CanDriveEmulator drive_;
  devices::SlcanEmulator adapter_;
  std::int64_t frames_ = 0;
};

}  // namespace curbstone::simulate::rig
