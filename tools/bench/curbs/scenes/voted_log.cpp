#include "tools/bench/curbs/scenes/voted_log.hpp"

#include <curbstone/map_pose_t.hpp>
#include <curbstone/voted_points_t.hpp>
#include <map>

#include "common/bus/local_bus.hpp"
#include "common/log/log_reader.hpp"
#include "common/log/message_order.hpp"
#include "services/ekf/ekf_node.hpp"
#include "services/mapper/mapper_node.hpp"
#include "services/semantic_map/tile/voted_tile_assembler.hpp"
#include "services/tensor_voting/worker/tensor_voting_node.hpp"
#include "tools/output/ordered_log.hpp"
#include "tools/output/watched_log.hpp"

namespace curbstone::bench::curbs::scenes {

namespace {

/// Filter, mapper and voting worker on one bus; collects their output.
class VotingChain {
 public:
  VotingChain() : ekf_({}, bus_), mapper_({}, bus_), voting_(config(), "tensor_voting", bus_) {
    for (Node* node : nodes_) node->connect(bus_);
    Subscriber& listener = bus_;
    listener.subscribe<voted_points_t>("VOTED_POINTS", [this](const voted_points_t& page) {
      const auto step = assembler_.add(page, refused_);
      if (!step) return;
      semantic_map::tile::VotedTile& tile = tiles_[step->key];
      if (semantic_map::tile::continues(*step, &tile)) semantic_map::tile::take_step(*step, tile);
    });
    listener.subscribe<map_pose_t>("MAP_POSE", [this](const map_pose_t& m) {
      Pose T = Pose::Identity();
      T.translation() = Eigen::Vector3d(m.map_base_position[0], m.map_base_position[1], m.map_base_position[2]);
      T.linear() = Eigen::Quaterniond(m.map_base_orientation[0], m.map_base_orientation[1], m.map_base_orientation[2],
                                      m.map_base_orientation[3])
                       .normalized()
                       .toRotationMatrix();
      result_.trajectory.push_back({m.utime, T});
    });
  }

  void feed(const LogEvent& event) {
    const std::int64_t now = message_time(event);
    bus_.inject(event.channel, event.bytes.data(), static_cast<int>(event.bytes.size()));
    bus_.dispatch();
    if (now - last_tick_ < kTick) return;
    last_tick_ = now;
    for (Node* node : nodes_) node->tick(now);
    bus_.dispatch();
  }
  DriveTiles finish() {
    for (Node* node : nodes_) {
      node->finish();
      bus_.dispatch();
    }
    for (auto& [key, tile] : tiles_) result_.tiles.push_back(std::move(tile));
    return std::move(result_);
  }

 private:
  static constexpr std::int64_t kTick = 1'000'000;  // us; no consumer waits for a tile
  static tensor_voting::worker::TensorVotingConfig config() {
    tensor_voting::worker::TensorVotingConfig config;
    config.bandwidth = 100;
    return config;
  }

  LocalBus bus_;
  ekf::EkfNode ekf_;
  mapper::MapperNode mapper_;
  tensor_voting::worker::TensorVotingNode voting_;
  std::vector<Node*> nodes_ = {&ekf_, &mapper_, &voting_};
  semantic_map::tile::VotedTileAssembler assembler_;
  Counters refused_;
  std::map<TileKey, semantic_map::tile::VotedTile> tiles_;
  DriveTiles result_;
  std::int64_t last_tick_ = 0;
};

}  // namespace

DriveTiles vote_log(const std::string& log) {
  VotingChain chain;
  output::WatchedLog reader(log, "bench curbs");
  output::read_in_order(reader, output::is_of_a_driver, [&](const LogEvent& event) { chain.feed(event); });
  return chain.finish();
}

}  // namespace curbstone::bench::curbs::scenes
