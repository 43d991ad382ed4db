// All services on one bus, and any messages on their channels: sensors that lie, a second mapper, damaged tiles. Input,
// repeated: channel (1 byte), time since the message before (2 bytes, 100 us), length (2 bytes), message without its
// fingerprint; the message's stamp is set to the time if the channel byte's highest bit is not set.
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <curbstone/imu_t.hpp>
#include <curbstone/lidar_points_t.hpp>
#include <curbstone/map_points_t.hpp>
#include <curbstone/map_pose_t.hpp>
#include <curbstone/map_trajectory_t.hpp>
#include <curbstone/odometry_t.hpp>
#include <curbstone/resend_request_t.hpp>
#include <curbstone/semantic_tile_t.hpp>
#include <curbstone/tile_index_t.hpp>
#include <curbstone/tile_request_t.hpp>
#include <curbstone/voted_points_t.hpp>
#include <curbstone/wheels_t.hpp>

#include "tests/fuzz/message.hpp"
#include "tests/fuzz/require.hpp"
#include "tools/replay/vehicle.hpp"

namespace curbstone::fuzz {
namespace {

struct Channel {
  const char* name;
  void (*inject)(LocalBus&, const std::string&, Bytes);
};
constexpr Channel kChannels[] = {{"LIDAR_POINTS", inject<lidar_points_t>},
                                 {"IMU", inject<imu_t>},
                                 {"WHEELS", inject<wheels_t>},
                                 {"ODOMETRY", inject<odometry_t>},
                                 {"MAP_POSE", inject<map_pose_t>},
                                 {"MAP_POINTS", inject<map_points_t>},
                                 {"VOTED_POINTS", inject<voted_points_t>},
                                 {"SEMANTIC_TILE", inject<semantic_tile_t>},
                                 {"TILE_INDEX", inject<tile_index_t>},
                                 {"TILE_REQUEST", inject<tile_request_t>},
                                 {"MAP_TRAJECTORY", inject<map_trajectory_t>},
                                 {"RESEND_REQUEST", inject<resend_request_t>},
                                 {"LIDAR_POINTS_AGAIN", inject<lidar_points_t>},
                                 {"ODOMETRY_AGAIN", inject<odometry_t>}};

/// Every message begins with its stamp.
void set_stamp(std::vector<std::uint8_t>& body, std::int64_t utime) {
  if (body.size() < 8) return;
  for (int i = 0; i < 8; ++i) body[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(utime >> (56 - 8 * i));
}

}  // namespace
}  // namespace curbstone::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace curbstone;
  static const std::string map = "/dev/shm/curbstone-fuzz-" + std::to_string(getpid()) + ".db";
  for (const char* part : {"", "-wal", "-shm"}) std::remove((map + part).c_str());
  LocalBus bus;
  replay::ReplayVehicle vehicle({.config_file = {}, .assignments = {}, .map_file = map}, bus);
  const auto finite = [](const double* values, int n) {
    for (int i = 0; i < n; ++i) fuzz::require(std::isfinite(values[i]), "what the services say is finite");
  };
  bool forged = false;  // what is on the bus is not all theirs
  bus.subscribe<odometry_t>("ODOMETRY", [&](const odometry_t& m) {
    if (!forged) finite(m.position, 3), finite(m.orientation, 4);
  });
  bus.subscribe<map_pose_t>("MAP_POSE", [&](const map_pose_t& m) {
    if (!forged) finite(m.map_base_position, 3), finite(m.map_base_orientation, 4);
  });
  std::int64_t now = 1'700'000'000'000'000;  // us
  for (fuzz::Input input(data, size); !input.empty();) {
    const auto choice = input.number<std::uint8_t>();
    now += 100 * input.number<std::uint16_t>();
    const fuzz::Bytes piece = input.piece();
    std::vector<std::uint8_t> body(piece.begin(), piece.end());
    if ((choice & 0x80) == 0) fuzz::set_stamp(body, now);
    const std::size_t index = (choice & 0x7F) % std::size(fuzz::kChannels);
    forged |= index >= 3;
    fuzz::kChannels[index].inject(bus, fuzz::kChannels[index].name, body);
    bus.dispatch();
    vehicle.advance(now);
  }
  vehicle.finish();
  for (const auto& stage : vehicle.stages()) (void)stage.node->report();
  return 0;
}
