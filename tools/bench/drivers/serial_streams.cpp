#include "tools/bench/drivers/serial_streams.hpp"

#include <cmath>
#include <deque>

#include "common/bus/local_bus.hpp"
#include "drivers/encoder/encoder_node.hpp"
#include "tools/simulate/devices/can_drive_emulator.hpp"
#include "tools/simulate/devices/wit_emulator.hpp"
#include "tools/simulate/devices/xsens_emulator.hpp"

namespace curbstone::bench::drivers {

namespace {

using encoder::can::CanFrame;

constexpr std::int64_t kStreamStart = 1'700'000'000'000'000;  // us
constexpr std::int64_t kDelay = 200;                          // us, transit time
constexpr double kCountsPerSecond = 6519;                     // 10 rad/s

template <class Device>
std::vector<TimedBytes> sampled(Device& device, std::int64_t period, double seconds) {
  std::vector<TimedBytes> stream;
  const auto samples = static_cast<std::int64_t>(seconds * 1e6) / period;
  for (std::int64_t i = 0; i < samples; ++i) {
    const std::int64_t taken = kStreamStart + i * period;
    simulate::devices::XsensSample sample;
    const double noise =
        0.01 * static_cast<double>(i % 2);  // an IMU without noise counts as stuck, and its samples are withheld
    sample.acceleration = {0.1 * std::sin(0.01 * static_cast<double>(i)) + noise, noise, 9.8 + noise};
    sample.angular_rate = {noise, noise, noise};
    sample.orientation = std::array{1.0, 0.0, 0.0, 0.0};
    stream.push_back({taken + kDelay, device.sample(taken, sample)});
  }
  return stream;
}

/// Registers 02 (frames: time, acceleration, rates, angle) and 03 (200 Hz), as the driver writes them.
void set_up(simulate::devices::WitEmulator& device) {
  const std::vector<std::vector<std::uint8_t>> commands = {
      {0xFF, 0xAA, 0x69, 0x88, 0xB5}, {0xFF, 0xAA, 0x02, 0x0F, 0x00}, {0xFF, 0xAA, 0x03, 0x0B, 0x00}};
  for (const auto& command : commands) device.on_bytes(command);
}

}  // namespace

std::vector<TimedBytes> imu_stream(imu::Model model, double seconds) {
  if (model == imu::Model::kWitMotion) {
    simulate::devices::WitEmulator device;
    device.power_on(kStreamStart - 1'000'000);
    set_up(device);
    return sampled(device, device.period(), seconds);
  }
  simulate::devices::XsensEmulator device({.configured = true});
  device.power_on(kStreamStart - 1'000'000);
  return sampled(device, device.period(), seconds);
}

std::vector<TimedFrame> encoder_stream(double seconds) {
  std::vector<TimedFrame> stream;
  LocalBus bus;
  std::deque<CanFrame> commands;
  encoder::EncoderNode node({}, bus, [&](const CanFrame& frame) { commands.push_back(frame); });
  simulate::devices::CanDriveEmulator drive;
  const auto receive = [&](std::int64_t at, const std::vector<CanFrame>& frames) {
    for (const CanFrame& frame : frames) {
      stream.push_back({at + kDelay, frame});
      node.on_frame(at + kDelay, frame);
    }
  };
  const auto drive_to = [&](std::int64_t at) {
    const auto counts = static_cast<std::int32_t>(static_cast<double>(at - kStreamStart) * 1e-6 * kCountsPerSecond);
    drive.set_counts(counts, -counts);
  };
  receive(kStreamStart, drive.power_on(kStreamStart));
  const std::int64_t end = kStreamStart + static_cast<std::int64_t>(seconds * 1e6);
  for (std::int64_t now = kStreamStart; now < end; now += 1000) {
    if ((now - kStreamStart) % 20'000 == 0) node.tick(now);
    for (; !commands.empty(); commands.pop_front()) {
      drive_to(now);
      receive(now, drive.on_frame(now, CanFrame(commands.front())));
    }
    for (auto due = drive.next_due(); due && *due < now + 1000; due = drive.next_due()) {
      drive_to(*due);
      receive(*due, drive.tick(*due));
    }
  }
  return stream;
}

}  // namespace curbstone::bench::drivers
