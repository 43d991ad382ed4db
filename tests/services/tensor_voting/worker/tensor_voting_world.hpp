#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>

#include "services/tensor_voting/worker/tensor_voting_node.hpp"
#include "tests/services/tensor_voting/voting_world.hpp"
#include "tests/stamps.hpp"

namespace curbstone::tensor_voting::worker {

using test::kSecond;
inline constexpr std::int64_t kTick = 20'000;

/// Mapper, workers and listener on one bus, with message time of its own.
struct World {
  explicit World(test_clouds::Tiles tiles, double trouble = 0, unsigned seed = 1, TensorVotingConfig used = {})
      : config(used),
        publisher(bus, trouble, seed),
        mapper(bus, publisher, std::move(tiles)),
        listener(bus, publisher) {}

  TensorVotingNode& start(const std::string& name) {
    nodes[name] = std::make_unique<TensorVotingNode>(config, name, publisher);
    nodes[name]->connect(bus);
    alive[name] = true;
    return *nodes[name];
  }
  void kill(const std::string& name) { alive[name] = false; }  // kill -9: nothing more from it

  void run(double seconds, double share_per_scan = 0) {
    for (const std::int64_t end = now + static_cast<std::int64_t>(seconds * 1e6); now < end; now += kTick) {
      if (share_per_scan > 0 && now % 100'000 < kTick) mapper.map(now, share_per_scan);
      mapper.tick(now);
      for (auto& [name, node] : nodes) {
        if (alive[name]) node->tick(now);
      }
      listener.tick(now);
      bus.dispatch();
    }
  }
  void finish() {
    for (auto& [name, node] : nodes) {
      if (alive[name]) node->finish();
    }
    bus.dispatch();
  }

  LocalBus bus;
  TensorVotingConfig config;
  test_world::LossyPublisher publisher;
  test_world::FakeMapper mapper;
  test_world::Listener listener;
  std::map<std::string, std::unique_ptr<TensorVotingNode>> nodes;
  std::map<std::string, bool> alive;
  std::int64_t now = 1'000'000 * kSecond;
};

inline test_clouds::Tiles street() {
  return test_clouds::as_tiles(test_clouds::street(20'000, 1));
}

/// One worker, nothing lost, everything at once.
inline const auto& lossless() {
  static const auto contents = [] {
    World world(street());
    world.start("tensor_voting:1");
    world.run(0.1, 1.0);
    world.finish();
    return world.listener.contents();
  }();
  return contents;
}

inline TensorVotingConfig two_scales() {
  TensorVotingConfig config;
  config.sigma = {0.3, 0.1};
  config.voxel = {0.1, 0.05};
  return config;
}

}  // namespace curbstone::tensor_voting::worker
