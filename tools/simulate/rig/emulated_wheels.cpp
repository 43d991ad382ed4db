#include "tools/simulate/rig/emulated_wheels.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace curbstone::simulate::rig {

namespace {

devices::CanDriveEmulator::Settings drive_settings() {
  devices::CanDriveEmulator::Settings settings;
  settings.clock_error = -40e-6;
  return settings;
}

}  // namespace

std::int16_t WheelDevice::decirpm(double speed) {
  return static_cast<std::int16_t>(std::lround(speed * 600.0 / (2.0 * std::numbers::pi)));
}

EmulatedWheels::EmulatedWheels(sensors::WheelModel model) : model_(std::move(model)), drive_(drive_settings()) {}

SerialDevice::Bytes EmulatedWheels::power_on(std::int64_t now) {
  drive_.set_enabled(true);
  Bytes bytes = to_host(drive_.power_on(now));
  drive_.set_enabled(true);  // a power cycle disables it
  return bytes;
}

SerialDevice::Bytes EmulatedWheels::on_bytes(std::int64_t now, std::span<const std::uint8_t> bytes) {
  auto [answers, frames] = adapter_.on_bytes(bytes);
  for (const auto& frame : frames) {
    const Bytes more = to_host(drive_.on_frame(now, frame));
    answers.insert(answers.end(), more.begin(), more.end());
  }
  return answers;
}

std::int64_t EmulatedWheels::next_due() const {
  return drive_.next_due().value_or(std::numeric_limits<std::int64_t>::max());
}

SerialDevice::Bytes EmulatedWheels::run(std::int64_t now, double t) {
  const auto counts = model_.counts(t);
  const auto speeds = model_.speeds();
  drive_.set_counts(static_cast<std::int32_t>(counts[0]),
                    static_cast<std::int32_t>(-counts[1]));  // wraps like the drive's counter
  drive_.set_speeds(decirpm(speeds[0]), decirpm(-speeds[1]));
  return to_host(drive_.tick(now));
}

SerialDevice::Bytes EmulatedWheels::to_host(const devices::CanDriveEmulator::Frames& frames) {
  Bytes bytes;
  for (const auto& frame : frames) {
    const Bytes line = adapter_.on_frame(frame);
    bytes.insert(bytes.end(), line.begin(), line.end());
    frames_ += line.empty() ? 0 : 1;
  }
  return bytes;
}

}  // namespace curbstone::simulate::rig
