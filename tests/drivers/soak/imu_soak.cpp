#include <chrono>
#include <cmath>
#include <curbstone/imu_t.hpp>

#include "common/bus/local_bus.hpp"
#include "drivers/imu/imu_node.hpp"
#include "tests/drivers/byte_stream.hpp"
#include "tests/drivers/soak/soak.hpp"
#include "tests/stamps.hpp"
#include "tools/simulate/devices/xsens_emulator.hpp"

namespace curbstone::test {

namespace {

using test::kStart;
constexpr std::int64_t kSamplePeriod = 10'000;
constexpr std::int64_t kCycle = 65'536;  // samples, distinguished by their acceleration

void flip_bits(Bytes& bytes, std::mt19937& random) {
  bytes[random() % bytes.size()] ^= static_cast<std::uint8_t>(1 + random() % 255);
}

}  // namespace

Soak soak_imu(double hours) {
  const auto begin = std::chrono::steady_clock::now();
  Soak soak;
  Ledger& ledger = soak.ledger;
  LocalBus bus;
  imu::ImuConfig config;
  config.configure = false;
  imu::ImuNode node(config, bus);
  simulate::devices::XsensEmulator device({.configured = true, .clock_error = 20e-6});
  device.power_on(kStart - 1'000'000);
  std::int64_t index = 0;
  bus.subscribe<imu_t>("IMU", [&](const imu_t& message) {
    const auto low = std::llround(message.acceleration[0] * 65536);
    const std::int64_t of = index - ((index - low) % kCycle + kCycle) % kCycle;
    ledger.used(of, message.utime - (kStart + of * kSamplePeriod));
  });
  Damage<Bytes> damage(1, {flip_bits, cut});
  std::mt19937 random(2);
  const auto samples = static_cast<std::int64_t>(hours * 3600e6) / kSamplePeriod;
  for (; index < samples; ++index) {
    const std::int64_t taken = kStart + index * kSamplePeriod;
    if (index % 2 == 0) node.tick(taken);
    simulate::devices::XsensSample sample;
    const double tremor = 1e-3 * static_cast<double>(index % 2);  // no sensor is still
    sample.acceleration = {static_cast<double>(index % kCycle) / 65536, tremor, 9.8 + tremor};
    const std::int64_t received = taken + 200 + static_cast<std::int64_t>(random() % 2000);
    const bool spare = index < 200 || index >= samples - 200;
    const Fate fate = damage.draw(spare);
    ledger.sent(index, fate);
    damage.pass(device.sample(taken, sample), fate, [&](const Bytes& bytes) { node.on_bytes(received, bytes); });
    bus.dispatch();
    if (index % 100 == 0) ledger.look(node.report(), static_cast<double>(index) / static_cast<double>(samples));
  }
  node.finish();
  bus.dispatch();
  soak.report = node.report();
  ledger.print("IMU (Xsens)", hours, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(),
               soak.report);
  return soak;
}

}  // namespace curbstone::test
