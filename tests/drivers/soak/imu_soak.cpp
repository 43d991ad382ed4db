#include <array>
#include <chrono>
#include <cmath>
#include <curbstone/imu_t.hpp>
#include <functional>

#include "common/bus/local_bus.hpp"
#include "common/geometry/gravity.hpp"
#include "drivers/imu/imu_node.hpp"
#include "tests/drivers/byte_stream.hpp"
#include "tests/drivers/soak/soak.hpp"
#include "tests/stamps.hpp"
#include "tools/simulate/devices/wit_emulator.hpp"
#include "tools/simulate/devices/xsens_emulator.hpp"

namespace curbstone::test {

namespace {

using test::kStart;
constexpr std::int64_t kSamplePeriod = 10'000;

/// An IMU on its line, and how its samples are distinguished: by their accelerations.
struct SoakedImu {
  const char* title;
  imu::Model model;
  std::int64_t cycle;  ///< samples
  std::function<Bytes(std::int64_t taken, const simulate::devices::XsensSample& sample)> send;
  std::function<std::array<double, 2>(std::int64_t number)> acceleration;  ///< x and y
  std::function<std::int64_t(const imu_t& message)> number;
};

void flip_bits(Bytes& bytes, std::mt19937& random) {
  bytes[random() % bytes.size()] ^= static_cast<std::uint8_t>(1 + random() % 255);
}

Soak soak_imu(const SoakedImu& soaked, double hours) {
  const auto begin = std::chrono::steady_clock::now();
  Soak soak;
  Ledger& ledger = soak.ledger;
  LocalBus bus;
  imu::ImuConfig config;
  config.model = soaked.model;
  config.configure = false;
  imu::ImuNode node(config, bus);
  std::int64_t index = 0;
  bus.subscribe<imu_t>("IMU", [&](const imu_t& message) {
    const std::int64_t low = soaked.number(message), cycle = soaked.cycle;
    const std::int64_t of = index - ((index - low) % cycle + cycle) % cycle;
    ledger.used(of, message.utime - (kStart + of * kSamplePeriod));
  });
  Damage<Bytes> damage(1, {flip_bits, cut});
  std::mt19937 random(2);
  const auto samples = static_cast<std::int64_t>(hours * 3600e6) / kSamplePeriod;
  for (; index < samples; ++index) {
    const std::int64_t taken = kStart + index * kSamplePeriod;
    if (index % 2 == 0) node.tick(taken);
    simulate::devices::XsensSample sample;
    const double tremor = 0.02 * static_cast<double>(index % 2);  // no sensor is still
    const auto [x, y] = soaked.acceleration(index % soaked.cycle);
    sample.acceleration = {x, y, 9.8 + tremor};
    sample.angular_rate = {tremor / 4, -tremor / 4, tremor / 4};
    sample.orientation = {{1, 0, 0, 0}};
    const std::int64_t received = taken + 200 + static_cast<std::int64_t>(random() % 2000);
    const bool spare = index < 200 || index >= samples - 200;
    const Fate fate = damage.draw(spare);
    ledger.sent(index, fate);
    damage.pass(soaked.send(taken, sample), fate, [&](const Bytes& bytes) { node.on_bytes(received, bytes); });
    bus.dispatch();
    if (index % 100 == 0) ledger.look(node.report(), static_cast<double>(index) / static_cast<double>(samples));
  }
  node.finish();
  bus.dispatch();
  soak.report = node.report();
  ledger.print(soaked.title, hours, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(),
               soak.report);
  return soak;
}

}  // namespace

Soak soak_xsens(double hours) {
  simulate::devices::XsensEmulator device({.configured = true, .clock_error = 20e-6});
  device.power_on(kStart - 1'000'000);
  constexpr std::int64_t kCycle = 65'536;
  return soak_imu({"IMU (Xsens)", imu::Model::kXsens, kCycle,
                   [&](std::int64_t taken, const auto& sample) { return device.sample(taken, sample); },
                   [](std::int64_t number) -> std::array<double, 2> {
                     return {static_cast<double>(number) / kCycle, 1e-3 * static_cast<double>(number % 2)};
                   },
                   [](const imu_t& message) -> std::int64_t { return std::llround(message.acceleration[0] * kCycle); }},
                  hours);
}

/// Its accelerations have 16 bits: the number is in the lowest six of x and of y.
Soak soak_witmotion(double hours) {
  constexpr double kStep = 16.0 / 32768 * kGravity;  // m/s^2
  constexpr std::int64_t kDigits = 64;
  simulate::devices::WitEmulator device;
  device.power_on(kStart - 1'000'000);
  // Unlocked; time, acceleration, rate of turn and quaternion; 100 Hz.
  device.on_bytes(from_hex("FF AA 69 88 B5 FF AA 02 07 02 FF AA 03 09 00"));
  return soak_imu(
      {"IMU (WitMotion)", imu::Model::kWitMotion, kDigits * kDigits,
       [&](std::int64_t taken, const auto& sample) { return device.sample(taken, sample); },
       [](std::int64_t number) -> std::array<double, 2> {
         return {kStep * static_cast<double>(number % kDigits), kStep * static_cast<double>(number / kDigits)};
       },
       [](const imu_t& message) -> std::int64_t {
         return std::llround(message.acceleration[0] / kStep) + kDigits * std::llround(message.acceleration[1] / kStep);
       }},
      hours);
}

}  // namespace curbstone::test
