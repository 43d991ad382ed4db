// Messages, datagrams, logs, and the first moments of a drive for the services.
#include <curbstone/map_points_t.hpp>
#include <curbstone/map_pose_t.hpp>
#include <curbstone/map_trajectory_t.hpp>
#include <curbstone/odometry_t.hpp>
#include <curbstone/resend_request_t.hpp>
#include <curbstone/semantic_tile_t.hpp>
#include <curbstone/service_status_t.hpp>
#include <curbstone/tile_index_t.hpp>
#include <curbstone/tile_request_t.hpp>
#include <curbstone/voted_points_t.hpp>
#include <procman_lcm/deputy_info_t.hpp>
#include <procman_lcm/discovery_t.hpp>
#include <procman_lcm/orders_t.hpp>

#include "common/log/log_writer.hpp"
#include "tests/fuzz/seeds/good_drive.hpp"
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

void put_message(Seed& seed, std::uint8_t channel, std::int64_t after, std::span<const std::uint8_t> message) {
  put(seed, channel);
  put(seed, static_cast<std::uint16_t>(after / 100));
  put_piece(seed, message);
}

/// For the services (nodes.cpp): a good drive, and then a message on each channel.
Seed drive(std::uint8_t turns) {
  Seed seed;
  put(seed, std::uint8_t{0xFF});
  put(seed, turns);
  const std::vector<std::vector<std::uint8_t>> messages = {body(points_of(turns * kPacketsPerTurn)),
                                                           body(imu_at_rest(1000)),
                                                           body(wheels_at(1000)),
                                                           body(odometry_t{}),
                                                           body(map_pose_t{}),
                                                           body(map_points_t{}),
                                                           body(voted_points_t{}),
                                                           body(semantic_tile_t{}),
                                                           body(tile_index_t{}),
                                                           body(tile_request_t{}),
                                                           body(map_trajectory_t{}),
                                                           body(resend_request_t{}),
                                                           body(points_of(0)),
                                                           body(odometry_t{})};
  for (std::size_t channel = 0; channel < messages.size(); ++channel)
    put_message(seed, static_cast<std::uint8_t>(channel), 1000, messages[channel]);
  return seed;
}

/// A turn's begin, packet by packet.
Seed packets(int count) {
  Seed seed;
  put_message(seed, 1, 500, body(imu_at_rest(0)));
  put_message(seed, 2, 500, body(wheels_at(0)));
  for (int i = 0; i < count; ++i) put_message(seed, 0, 1300, body(points_of(i)));
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
  const test::TemporaryFolder folder;
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
  folder.write("nodes", "drive", drive(7));
  folder.write("nodes", "start", drive(0));
  folder.write("nodes", "packets", packets(8));
}

}  // namespace curbstone::fuzz
