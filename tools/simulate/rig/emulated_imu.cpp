#include "tools/simulate/rig/emulated_imu.hpp"

#include <cmath>
#include <utility>

namespace curbstone::simulate::rig {

namespace {

constexpr double kClockError = 20e-6;  // the device's oscillator is 20 ppm fast

devices::XsensEmulator::Settings imu_settings() {
  devices::XsensEmulator::Settings settings;
  settings.first_tick = 1'234'567;
  settings.clock_error = kClockError;
  return settings;
}

}  // namespace

EmulatedImu::EmulatedImu(sensors::ImuModel model, bool witmotion)
    : model_(std::move(model)), witmotion_(witmotion), xsens_(imu_settings()) {}

SerialDevice::Bytes EmulatedImu::power_on(std::int64_t now) {
  wit_.power_on(now);
  due_ = now + period();
  return witmotion_ ? Bytes{} : xsens_.power_on(now);
}

SerialDevice::Bytes EmulatedImu::on_bytes(std::int64_t now, std::span<const std::uint8_t> bytes) {
  if (!witmotion_) return xsens_.on_bytes(now, bytes);
  wit_.on_bytes(bytes);  // it does not respond
  return {};
}

SerialDevice::Bytes EmulatedImu::run(std::int64_t now, double t) {
  if (now < due_) return {};
  due_ += period();
  if (due_ <= now) due_ = now + period();  // after a pause of the emulator
  if (!witmotion_ && !xsens_.measuring(now)) return {};
  const motion::Inertia inertia = model_.sample(t);
  devices::XsensSample sample;
  for (std::size_t i = 0; i < 3; ++i) {
    sample.acceleration[i] = inertia.specific_force[static_cast<Eigen::Index>(i)];
    sample.angular_rate[i] = inertia.angular_rate[static_cast<Eigen::Index>(i)];
  }
  sample.orientation = model_.orientation(t);
  ++samples_;
  return witmotion_ ? wit_.sample(now, sample) : xsens_.sample(now, sample);
}

}  // namespace curbstone::simulate::rig
