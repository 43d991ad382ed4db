// Messages, datagrams, logs, and the first moments of a drive for the services.
#include <cmath>
#include <curbstone/imu_t.hpp>
#include <curbstone/lidar_points_t.hpp>
#include <curbstone/map_pose_t.hpp>
#include <curbstone/odometry_t.hpp>
#include <curbstone/service_status_t.hpp>
#include <curbstone/tile_index_t.hpp>
#include <curbstone/tile_request_t.hpp>
#include <curbstone/wheels_t.hpp>
#include <procman_lcm/deputy_info_t.hpp>
#include <procman_lcm/discovery_t.hpp>
#include <procman_lcm/orders_t.hpp>

#include "common/log/log_writer.hpp"
#include "tests/fuzz/seeds/seed_folder.hpp"
#include "tests/temporary_folder.hpp"

namespace curbstone::fuzz {
namespace {

template <class Message>
std::vector<std::uint8_t> encoded(const Message& message) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  (void)message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}
/// Without the fingerprint, as the targets put it in.
template <class Message>
std::vector<std::uint8_t> body(const Message& message) {
  const std::vector<std::uint8_t> bytes = encoded(message);
  return {bytes.begin() + 8, bytes.end()};
}

imu_t imu_at_rest(int sequence) {
  imu_t m{};
  m.sequence = sequence;
  m.acceleration[2] = 9.81;
  m.temperature = 25;
  return m;
}

wheels_t wheels_at(int sequence) {
  wheels_t m{};
  m.sequence = sequence;
  for (int side = 0; side < 2; ++side) {
    m.counts[side] = 100 * sequence;
    m.angle[side] = 0.1 * sequence;
    m.speed[side] = 5;
  }
  m.enabled = true;
  return m;
}

/// 24 points on a wall around, of one packet.
lidar_points_t points_of(int packet) {
  lidar_points_t m{};
  m.packet = packet;
  m.revolution = packet / 38;
  m.num_points = 24;
  for (int i = 0; i < m.num_points; ++i) {
    const double azimuth = 2 * M_PI * (packet % 38 + i / 24.0) / 38;
    m.x.push_back(static_cast<float>(8 * std::cos(azimuth)));
    m.y.push_back(static_cast<float>(-8 * std::sin(azimuth)));
    m.z.push_back(-1.7F + 0.3F * static_cast<float>(i % 8));
    m.time_offset.push_back(static_cast<float>(i) * 5e-5F);
    m.intensity.push_back(static_cast<std::int8_t>(20 + i));
    m.ring.push_back(static_cast<std::int8_t>(i % 16));
  }
  return m;
}

enum NodeChannel : std::uint8_t { kPoints = 0, kImu = 1, kWheels = 2, kTileIndex = 8, kTileRequest = 9 };

void put_message(Seed& seed, std::uint8_t channel, std::int64_t after, std::span<const std::uint8_t> message) {
  put(seed, channel);
  put(seed, static_cast<std::uint16_t>(after / 100));
  put_piece(seed, message);
}

Seed drive(double seconds) {
  Seed seed;
  for (int i = 0; i < static_cast<int>(100 * seconds); ++i) {
    put_message(seed, kImu, 4000, body(imu_at_rest(i)));
    if (i % 2 == 0) put_message(seed, kWheels, 500, body(wheels_at(i / 2)));
    for (int k = 0; k < 7; ++k) put_message(seed, kPoints, 800, body(points_of(7 * i + k)));
  }
  put_message(seed, kTileIndex, 1000, body(tile_index_t{}));
  put_message(seed, kTileRequest, 1000, body(tile_request_t{}));
  return seed;
}

Seed whole_datagram(std::string_view channel, const std::vector<std::uint8_t>& message) {
  Seed seed;
  put(seed, bytes_of("LC02"));
  put(seed, std::uint32_t{0});
  put(seed, bytes_of(channel));
  put(seed, std::uint8_t{0});
  put(seed, message);
  return seed;
}

Seed log() {
  const testing::TemporaryFolder folder;
  const std::string file = folder / "seed.lcmlog";
  {
    LogWriter writer(file);
    for (int i = 0; i < 5; ++i) {
      const std::vector<std::uint8_t> bytes = encoded(imu_at_rest(i));
      writer.write("IMU", bytes.data(), static_cast<int>(bytes.size()), 1'700'000'000'000'000 + i * 10'000);
    }
  }
  return SeedFolder::read(file);
}

Seed order() {
  procman_lcm::orders_t orders{};
  orders.deputy_id = "vehicle";
  orders.sheriff_id = "host:1:1";
  orders.ncmds = 1;
  orders.cmds.resize(1);
  orders.cmds[0].cmd.exec_str = "curbstone-imu --config ugv.yaml";
  orders.cmds[0].cmd.command_id = "imu";
  orders.cmds[0].desired_runid = 1;
  Seed seed;
  put(seed, std::uint8_t{0});
  put_piece(seed, body(orders));
  put(seed, std::uint8_t{1});
  put_piece(seed, body(procman_lcm::deputy_info_t{}));
  put(seed, std::uint8_t{2});
  put_piece(seed, body(procman_lcm::discovery_t{}));
  return seed;
}

}  // namespace

void write_bus_seeds(const SeedFolder& folder) {
  const std::vector<std::pair<std::uint8_t, std::vector<std::uint8_t>>> messages = {
      {1, body(imu_at_rest(1))},      {2, body(points_of(1))},    {4, body(map_pose_t{})},      {6, body(odometry_t{})},
      {10, body(service_status_t{})}, {11, body(tile_index_t{})}, {12, body(tile_request_t{})}, {14, body(wheels_t{})}};
  for (const auto& [type, message] : messages) {
    Seed seed = {type};
    put(seed, message);
    folder.write("messages", "type_" + std::to_string(type), seed);
  }
  folder.write("orders", "start", order());
  folder.write("datagram", "imu", whole_datagram("IMU", encoded(imu_at_rest(1))));
  folder.write("datagram", "foreign", whole_datagram(std::string(63, 'X'), {}));
  Seed relayed;
  put(relayed, bytes_of("CBR1"));
  put(relayed, std::vector<std::uint8_t>(12));
  folder.write("relay_frame", "sign_of_life", relayed);
  put(relayed, bytes_of(std::string_view("IMU\0", 4)));
  put(relayed, encoded(imu_at_rest(1)));
  folder.write("relay_frame", "imu", relayed);
  folder.write("log", "imu", log());
  const Seed recorded = SeedFolder::read(folder.recording("lcm/botlab_convex.lcmlog"));
  if (!recorded.empty()) folder.write("log", "recorded", recorded);
  folder.write("nodes", "drive", drive(0.5));
  folder.write("nodes", "start", drive(0.1));
}

}  // namespace curbstone::fuzz
