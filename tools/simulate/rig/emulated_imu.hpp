#pragma once

#include "tools/simulate/devices/wit_emulator.hpp"
#include "tools/simulate/devices/xsens_emulator.hpp"
#include "tools/simulate/rig/serial_device.hpp"
#include "tools/simulate/sensors/imu_model.hpp"

namespace curbstone::simulate::rig {

/// An Xsens MTi or a WitMotion on the vehicle.
class EmulatedImu final : public SerialDevice {
 public:
  explicit EmulatedImu(sensors::ImuModel model, bool witmotion = false);

  Bytes power_on(std::int64_t now) override;
  Bytes on_bytes(std::int64_t now, std::span<const std::uint8_t> bytes) override;
  [[nodiscard]] std::int64_t next_due() const override { return due_; }
  Bytes run(std::int64_t now, double t) override;
  [[nodiscard]] std::int64_t samples() const { return samples_; }

 private:
  [[nodiscard]] std::int64_t period() const { return witmotion_ ? wit_.period() : xsens_.period(); }

  sensors::ImuModel model_;
  bool witmotion_;
  devices::XsensEmulator xsens_;
  devices::WitEmulator wit_;
  std::int64_t due_ = 0;
  std::int64_t samples_ = 0;
};

}  // namespace curbstone::simulate::rig
