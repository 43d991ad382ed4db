// All services on one bus, and any messages on their channels: sensors that lie, a second mapper, damaged tiles. Input,
// repeated: channel (1 byte), time since the message before (2 bytes, 100 us), length (2 bytes), message without its
// fingerprint; the message's stamp is set to the time if the channel byte's highest bit is not set. Or 255 and a byte:
// up to eight turns of a good drive, so that an input of a few bytes gets beyond the first revolutions.
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
#include <memory>
#include <string>
#include <vector>

#include "services/ekf/base/ekf_config.hpp"
#include "services/ekf/ekf_node.hpp"
#include "services/mapper/config/mapper_config.hpp"
#include "services/mapper/mapper_node.hpp"
#include "services/semantic_map/semantic_map_config.hpp"
#include "services/semantic_map/semantic_map_node.hpp"
#include "services/tensor_voting/worker/tensor_voting_config.hpp"
#include "services/tensor_voting/worker/tensor_voting_node.hpp"
#include "tests/fuzz/seeds/good_drive.hpp"
#include "tests/fuzz/support/message.hpp"
#include "tests/fuzz/support/require.hpp"

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

/// The nodes' settings, read once. The same paths as the vehicle's, and maps of which a few hundred points fill the
/// voxels: an input's time would go into registering one scan from many speeds, and into threads.
struct Settings {
  ekf::base::EkfConfig ekf;
  mapper::config::MapperConfig mapper;
  tensor_voting::worker::TensorVotingConfig voting;
  semantic_map::SemanticMapConfig semantic;

  Settings() {
    ekf.state_file.clear();
    mapper.journal.clear();
    mapper.threads = 1;
    mapper.tracker.max_speed = 10;
    mapper.tracker.min_points = 100;
    mapper.registration.icp.source_voxel = 0.5;
    mapper.registration.icp.fine_voxel = 1;
    mapper.registration.icp.coarse_voxel = 3;
    mapper.registration.icp.max_iterations = 4;
    mapper.dense.voxel = 0.25;
    mapper.dense.max_points = 100'000;
    semantic.map = "/dev/shm/curbstone-fuzz-" + std::to_string(getpid()) + ".db";
    semantic.keep_earlier_drives = false;
    semantic.picture.clear();
  }
};

/// The services as in a replay, in one thread.
class Vehicle {
 public:
  Vehicle() {
    static const Settings settings;
    for (const char* part : {"", "-wal", "-shm"}) std::remove((settings.semantic.map + part).c_str());
    nodes_.push_back(std::make_unique<ekf::EkfNode>(settings.ekf, bus));
    nodes_.push_back(std::make_unique<mapper::MapperNode>(settings.mapper, bus));
    nodes_.push_back(
        std::make_unique<tensor_voting::worker::TensorVotingNode>(settings.voting, "tensor_voting:1", bus));
    nodes_.push_back(std::make_unique<semantic_map::SemanticMapNode>(settings.semantic, bus));
    for (const auto& node : nodes_) node->connect(bus);
  }
  /// A tick each tenth of a second of message time, and but one after a gap.
  void advance(std::int64_t now) {
    bus.dispatch();
    if (std::abs(now - ticked_) < kTick) return;
    ticked_ = now;
    for (const auto& node : nodes_) {
      node->tick(now);
      bus.dispatch();
    }
  }
  /// 50 ms of it.
  void drive_a_turn(std::int64_t& now) {
    for (int i = 0; i < kPacketsPerTurn; ++i, now += 50'000 / kPacketsPerTurn) {
      if (i % 8 == 0) send("IMU", imu_at_rest(samples_), now);
      if (i % 16 == 0) send("WHEELS", wheels_at(samples_ / 2), now);
      if (i % 8 == 0) ++samples_;
      send("LIDAR_POINTS", points_of(packets_++), now);
    }
    advance(now);
  }
  void finish() {
    for (const auto& node : nodes_) {
      node->finish();
      bus.dispatch();
    }
    for (const auto& node : nodes_) (void)node->report();
  }

  LocalBus bus;

 private:
  static constexpr std::int64_t kTick = 100'000;  // us

  template <class Message>
  void send(const char* channel, Message message, std::int64_t now) {
    message.utime = now;
    bus.publish(channel, message);
    bus.dispatch();
  }

  std::vector<std::unique_ptr<Node>> nodes_;
  std::int64_t ticked_ = 0;  // us
  int samples_ = 0;
  int packets_ = 0;
};

}  // namespace
}  // namespace curbstone::fuzz

/// Maps are made and freed for each input: with the usual 256 MB, each page of them would be a new one.
extern "C" const char* __asan_default_options() {
  return "quarantine_size_mb=16";
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace curbstone;
  fuzz::Vehicle vehicle;
  LocalBus& bus = vehicle.bus;
  const auto finite = [](const double* values, int n) {
    for (int i = 0; i < n; ++i) fuzz::require(std::isfinite(values[i]), "what the services say is finite");
  };
  constexpr int kMaxTurns = 10;
  bool forged = false;  // what is on the bus is not all theirs
  bus.subscribe<odometry_t>("ODOMETRY", [&](const odometry_t& m) {
    if (!forged) finite(m.position, 3), finite(m.orientation, 4);
  });
  bus.subscribe<map_pose_t>("MAP_POSE", [&](const map_pose_t& m) {
    if (!forged) finite(m.map_base_position, 3), finite(m.map_base_orientation, 4);
  });
  std::int64_t now = 1'700'000'000'000'000;  // us
  int turns = 0;
  for (fuzz::Input input(data, size); !input.empty();) {
    const auto choice = input.number<std::uint8_t>();
    if (choice == 0xFF) {
      for (int more = input.number<std::uint8_t>() % 8 + 1; more > 0 && turns < kMaxTurns; --more, ++turns)
        vehicle.drive_a_turn(now);
      continue;
    }
    now += 100 * input.number<std::uint16_t>();
    const fuzz::Bytes piece = input.piece();
    std::vector<std::uint8_t> body(piece.begin(), piece.end());
    if ((choice & 0x80) == 0) fuzz::set_stamp(body, now);
    const std::size_t index = (choice & 0x7F) % std::size(fuzz::kChannels);
    forged |= index >= 3;
    fuzz::kChannels[index].inject(bus, fuzz::kChannels[index].name, body);
    vehicle.advance(now);
  }
  vehicle.finish();
  return 0;
}
