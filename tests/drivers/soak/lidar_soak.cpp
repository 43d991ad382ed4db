#include <array>
#include <chrono>
#include <cmath>
#include <curbstone/lidar_points_t.hpp>
#include <functional>
#include <string>
#include <vector>

#include "common/bus/local_bus.hpp"
#include "drivers/lidar/lidar_node.hpp"
#include "tests/drivers/byte_stream.hpp"
#include "tests/drivers/soak/soak.hpp"
#include "tests/stamps.hpp"
#include "tools/simulate/devices/make_lidar.hpp"

namespace curbstone::test {

namespace {

using lidar::models::ModelName;
using simulate::devices::LidarName;

using test::kStart;

struct SoakedModel {
  const char* title;
  ModelName model;
  LidarName device;
  std::function<void(Bytes&, std::mt19937&)> corrupt;
};

std::uint8_t flipped(std::mt19937& random) {
  return static_cast<std::uint8_t>(1 + random() % 255);
}

/// Damages what a driver can see: in the head, if there is one, a magic and a time; flag and azimuth of a block.
std::function<void(Bytes&, std::mt19937&)> corrupt_head(std::size_t magic, std::size_t time, std::size_t time_size,
                                                        std::size_t blocks) {
  return [=](Bytes& bytes, std::mt19937& random) {
    const std::size_t block = blocks + 100 * (random() % 12);
    std::vector<std::size_t> places = {time + random() % time_size, block + random() % 2, block + 2 + random() % 2};
    if (magic > 0) places.push_back(random() % magic);
    bytes[places[random() % places.size()]] ^= flipped(random);
  };
}

Soak soak_model(const SoakedModel& soaked, double hours) {
  const auto begin = std::chrono::steady_clock::now();
  Soak soak;
  Ledger& ledger = soak.ledger;
  LocalBus bus;
  lidar::LidarConfig config;
  config.model = soaked.model;
  config.clock = lidar::decoding::ClockMode::kDevice;
  lidar::LidarNode node(config, bus);
  const auto device = simulate::devices::make_lidar(soaked.device, 1200);
  const auto& table = device->table();
  const double firing = table.firing_period * 1e6;  // us
  const double period = table.packet_period() * 1e6;
  const auto sent_at = [&](std::int64_t index) { return kStart + std::llround(static_cast<double>(index) * period); };
  // The first three lasers' first shots say which packet it is.
  bus.subscribe<lidar_points_t>("LIDAR_POINTS", [&](const lidar_points_t& message) {
    if (message.num_points < 3) return ledger.used(-1, 0);
    const std::int64_t index = message.intensity[0] | message.intensity[1] << 8 | message.intensity[2] << 16;
    ledger.used(index, message.utime - sent_at(index));
  });

  std::vector<simulate::devices::LidarShot> shots(static_cast<std::size_t>(table.lasers));
  Damage<Bytes> damage(5, {soaked.corrupt, cut});
  std::mt19937 random(6);
  const auto packets = static_cast<std::int64_t>(hours * 3600e6 / period);
  const auto a_second = static_cast<std::int64_t>(1e6 / period);
  std::int64_t number = 0;  // of the firing
  const auto fire = [&] {
    const double azimuth = static_cast<double>(number) * device->azimuth_step();
    const std::int64_t at = kStart + std::llround(static_cast<double>(number++) * firing);
    return device->add_firing(at, std::fmod(azimuth, 360.0), shots);
  };
  std::int64_t next_info = kStart;
  for (std::int64_t index = 0; index < packets; ++index) {
    shots.assign(shots.size(), {10.0F, 100});
    for (std::size_t i = 0; i < 3; ++i) shots[i].intensity = static_cast<std::uint8_t>(index >> (8 * i));
    auto packet = fire();
    for (shots.assign(shots.size(), {10.0F, 100}); !packet;) packet = fire();
    const std::int64_t sent = sent_at(index + 1);
    const std::int64_t received = sent + 60 + static_cast<std::int64_t>(random() % 500);
    if (sent >= next_info) {
      // A Helios has no points before it has sent two.
      for (int i = 0; i < (index == 0 ? 2 : 1); ++i) node.on_packet(received, table.info_port, device->info(sent));
      next_info = sent + 1'000'000;
    }
    if (index == 0) continue;
    const bool spare = index < 2 * a_second || index >= packets - 2 * a_second;
    const Fate fate = damage.draw(spare);
    ledger.sent(index, fate);
    damage.pass(*packet, fate, [&](const Bytes& bytes) { node.on_packet(received, table.point_port, bytes); });
    bus.dispatch();
    if (index % 15 == 0) node.tick(received);
    if (index % a_second == 0) ledger.look(node.report(), static_cast<double>(index) / static_cast<double>(packets));
  }
  node.finish();
  bus.dispatch();
  soak.report = node.report();
  ledger.print(soaked.title, hours, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(),
               soak.report);
  return soak;
}

}  // namespace

Soak soak_rs16(double hours) {
  return soak_model({"LiDAR (RS16)", ModelName::kRs16, LidarName::kRs16, corrupt_head(8, 20, 10, 42)}, hours);
}

Soak soak_vlp16(double hours) {
  return soak_model({"LiDAR (VLP-16)", ModelName::kVlp16, LidarName::kVlp16, corrupt_head(0, 1200, 4, 0)}, hours);
}

Soak soak_helios32(double hours) {
  return soak_model(
      {"LiDAR (Helios, 32 lasers)", ModelName::kHelios32, LidarName::kHelios32, corrupt_head(4, 20, 10, 42)}, hours);
}

}  // namespace curbstone::test
