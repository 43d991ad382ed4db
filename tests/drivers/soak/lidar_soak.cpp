#include <algorithm>
#include <array>
#include <chrono>
#include <curbstone/lidar_points_t.hpp>
#include <vector>

#include "common/bus/local_bus.hpp"
#include "drivers/lidar/lidar_node.hpp"
#include "tests/drivers/byte_stream.hpp"
#include "tests/drivers/soak/soak.hpp"
#include "tests/stamps.hpp"
#include "tools/simulate/devices/rs16_emulator.hpp"

namespace curbstone::test {

namespace {

using test::kStart;
constexpr std::int64_t kPacketPeriod = 1332;
constexpr int kMsopPort = 6699, kDifopPort = 7788;

/// Where a driver can see it: magic, time, flag and azimuth of a block.
void corrupt_head(Bytes& bytes, std::mt19937& random) {
  const std::size_t block = 42 + 100 * (random() % 12);
  const std::array<std::size_t, 4> places = {random() % 8, 20 + random() % 10, block + random() % 2,
                                             block + 2 + random() % 2};
  bytes[places[random() % places.size()]] ^= static_cast<std::uint8_t>(1 + random() % 255);
}

}  // namespace

Soak soak_lidar(double hours) {
  const auto begin = std::chrono::steady_clock::now();
  Soak soak;
  Ledger& ledger = soak.ledger;
  LocalBus bus;
  lidar::LidarConfig config;
  config.clock = lidar::decoding::ClockMode::kDevice;
  lidar::LidarNode node(config, bus);
  bus.subscribe<lidar_points_t>("LIDAR_POINTS", [&](const lidar_points_t& message) {
    if (message.num_points < 3) return ledger.used(-1, 0);
    const std::int64_t index = message.intensity[0] | message.intensity[1] << 8 | message.intensity[2] << 16;
    ledger.used(index, message.utime - (kStart + index * kPacketPeriod));
  });

  simulate::devices::Rs16Emulator device;
  std::array<simulate::devices::LidarShot, 16> shots;
  Damage<Bytes> damage(5, {corrupt_head, cut});
  std::mt19937 random(6);
  const auto packets = static_cast<std::int64_t>(hours * 3600e6) / kPacketPeriod;
  std::int64_t sequence = 0;
  for (std::int64_t index = 0; index < packets; ++index) {
    shots.fill({10.0F, 100});
    for (std::size_t i = 0; i < 3; ++i) shots[i].intensity = static_cast<std::uint8_t>(index >> (8 * i));
    auto packet = device.add_sequence(kStart + index * kPacketPeriod,
                                      static_cast<double>(sequence) * device.azimuth_step(), shots);
    shots.fill({10.0F, 100});
    for (++sequence; !packet; ++sequence) {
      packet = device.add_sequence(kStart + sequence * 111 / 2, static_cast<double>(sequence) * device.azimuth_step(),
                                   shots);
    }
    const std::int64_t sent = kStart + (index + 1) * kPacketPeriod;
    const std::int64_t received = sent + 60 + static_cast<std::int64_t>(random() % 500);
    if (index % 750 == 0) node.on_packet(received, kDifopPort, device.difop(sent, 1200));
    const bool spare = index < 1500 || index >= packets - 1500;
    const Fate fate = damage.draw(spare);
    ledger.sent(index, fate);
    damage.pass(Bytes(packet->begin(), packet->end()), fate,
                [&](const Bytes& bytes) { node.on_packet(received, kMsopPort, bytes); });
    bus.dispatch();
    if (index % 15 == 0) node.tick(received);
    if (index % 750 == 0) ledger.look(node.report(), static_cast<double>(index) / static_cast<double>(packets));
  }
  node.finish();
  bus.dispatch();
  soak.report = node.report();
  ledger.print("LiDAR (RS16)", hours, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(),
               soak.report);
  return soak;
}

}  // namespace curbstone::test
