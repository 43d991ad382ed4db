#include "drivers/imu/auto_device.hpp"

#include <utility>

#include "drivers/imu/witmotion/wit_device.hpp"
#include "drivers/imu/xsens/xsens_device.hpp"

namespace curbstone::imu {

namespace {
constexpr std::int64_t kXbusFrames = 3;
constexpr std::int64_t kWitFrames = 8;  // their sum is weaker, and a sample has four frames
}  // namespace

AutoDevice::AutoDevice(const device::DeviceSettings& settings, Send send)
    : settings_(settings), send_(std::move(send)) {}

void AutoDevice::on_bytes(std::int64_t now, std::span<const std::uint8_t> bytes, const Handler& handler) {
  if (found_) {
    found_->on_bytes(now, bytes, handler);
  } else {
    listen(now, bytes);
  }
}

void AutoDevice::listen(std::int64_t now, std::span<const std::uint8_t> bytes) {
  xbus_.parse(now, bytes, [](const auto&) {});
  wit_.parse(bytes, [](const auto&) {});
  if (xbus_.counters()["frames"] >= kXbusFrames) {
    found_ = std::make_unique<xsens::XsensDevice>(settings_, send_);
  } else if (wit_.counters()["frames"] >= kWitFrames) {
    found_ = std::make_unique<witmotion::WitDevice>(settings_, send_);
  }
  if (found_) found_->on_link(now, link::LinkState::kUp);
}

void AutoDevice::on_link(std::int64_t now, link::LinkState state) {
  xbus_ = {};  // another device may have been plugged in
  wit_ = {};
  if (state == link::LinkState::kUp) found_.reset();
  if (found_) found_->on_link(now, state);
}

void AutoDevice::tick(std::int64_t now) {
  if (found_) found_->tick(now);
}

Counters AutoDevice::counters() const {
  return found_ ? found_->counters() : Counters{};
}

std::string AutoDevice::fault() const {
  return found_ ? found_->fault()
                : "no model of IMU has been recognised: if it is silent until it is set up, name its model";
}

}  // namespace curbstone::imu
