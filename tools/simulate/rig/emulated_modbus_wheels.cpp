#include "tools/simulate/rig/emulated_modbus_wheels.hpp"

#include <utility>

namespace curbstone::simulate::rig {

namespace {
// us, at 115200 baud: 87 us per byte. The drive samples the counts when it has the request, and replies a little later.
constexpr std::int64_t kRequest = 700;
constexpr std::int64_t kReply = 2'800;
}  // namespace

SerialDevice::Bytes EmulatedModbusWheels::on_bytes(std::int64_t now, std::span<const std::uint8_t> bytes) {
  if (drive_.on_bytes(bytes)) due_ = now + kRequest;
  return {};
}

SerialDevice::Bytes EmulatedModbusWheels::run(std::int64_t now, double t) {
  if (reply_.empty()) {
    const auto counts = model_.counts(t);
    const auto speeds = model_.speeds();
    drive_.set_counts(static_cast<std::int32_t>(counts[0]), static_cast<std::int32_t>(-counts[1]));
    drive_.set_speeds(decirpm(speeds[0]), decirpm(-speeds[1]));
    reply_ = drive_.answer();
    due_ = now + kReply;
    return {};
  }
  due_ = kNever;
  ++replies_;
  return std::exchange(reply_, {});
}

}  // namespace curbstone::simulate::rig
