#pragma once

#include <memory>

#include "drivers/imu/device/imu_device.hpp"
#include "drivers/imu/witmotion/wit_frame.hpp"
#include "drivers/imu/xsens/xbus_frame.hpp"
#include "drivers/link/link_state.hpp"

namespace curbstone::imu {

/// Becomes the model whose frames are received first. Until then nothing is sent, because a command for one model may
/// mean anything to another. So a device that is silent until it is set up needs its model's name in the config.
class AutoDevice final : public device::ImuDevice {
 public:
  AutoDevice(const device::DeviceSettings& settings, Send send);

  void on_bytes(std::int64_t now, std::span<const std::uint8_t> bytes, const Handler& handler) override;
  void on_link(std::int64_t now, link::LinkState state) override;
  void tick(std::int64_t now) override;
  [[nodiscard]] Counters counters() const override;
  [[nodiscard]] std::string fault() const override;

 private:
  void listen(std::int64_t now, std::span<const std::uint8_t> bytes);

  device::DeviceSettings settings_;
  Send send_;
  xsens::XbusParser xbus_;
  witmotion::WitParser wit_;
  std::unique_ptr<device::ImuDevice> found_;
};

}  // namespace curbstone::imu
