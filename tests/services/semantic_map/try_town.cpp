// A workbench for a drive:
//   try_town record LOG OUT   a log of the drivers' messages -> the poses and the final voted tiles, as a log
//   try_town map IN MAP [KEY=VALUE...]   that -> the map file and MAP.png
#include <fmt/format.h>

#include <chrono>
#include <cstring>
#include <map>

#include "common/local_bus.hpp"
#include "services/ekf/ekf_node.hpp"
#include "services/mapper/mapper_node.hpp"
#include "services/semantic_map/semantic_map_node.hpp"
#include "services/tensor_voting/tensor_voting_node.hpp"
#include "tools/log/log_reader.hpp"
#include "tools/log/log_writer.hpp"
#include "tools/log/message_order.hpp"

using namespace curbstone;

namespace {

void record(const std::string& log, const std::string& out) {
  struct Revision {
    std::int32_t revision = 0;
    std::vector<std::vector<std::uint8_t>> pages;
  };
  std::map<TileKey, Revision> voted;
  LogWriter writer(out);
  LocalBus bus;
  bus.set_tap([&](const std::string& channel, const void* data, int size) {
    if (channel == "MAP_POSE") writer.write(channel, data, size);
    if (channel != "VOTED_POINTS") return;
    voted_points_t m;
    if (m.decode(data, 0, size) < 0) return;
    Revision& r = voted[{m.tile_x, m.tile_y}];
    if (m.revision < r.revision) return;
    if (m.revision > r.revision) r = {m.revision, {}};
    const auto* bytes = static_cast<const std::uint8_t*>(data);
    r.pages.emplace_back(bytes, bytes + size);
  });
  EkfNode ekf({}, bus);
  MapperNode mapper({}, bus);
  TensorVotingConfig voting_config;
  voting_config.bandwidth = 1000;
  TensorVotingNode voting(voting_config, "tensor_voting", bus);
  const std::vector<Node*> nodes = {&ekf, &mapper, &voting};
  for (Node* node : nodes) node->connect(bus);
  LogReader reader(log);
  MessageOrder order;
  std::int64_t last_tick = 0;
  const auto feed = [&](const LogEvent& event) {
    const std::int64_t now = message_time(event);
    bus.inject(event.channel, event.bytes.data(), static_cast<int>(event.bytes.size()));
    bus.dispatch();
    if (now - last_tick < 20'000) return;
    last_tick = now;
    for (Node* node : nodes) node->tick(now);
    bus.dispatch();
  };
  while (auto event = reader.next()) {
    if (event->channel != "LIDAR_POINTS" && event->channel != "IMU" && event->channel != "WHEELS") continue;
    order.push(std::move(*event));
    while (auto next = order.pop(false)) feed(*next);
  }
  while (auto next = order.pop(true)) feed(*next);
  for (Node* node : nodes) {
    node->finish();
    bus.dispatch();
  }
  for (const auto& [key, revision] : voted) {
    for (const auto& page : revision.pages) writer.write("VOTED_POINTS", page.data(), static_cast<int>(page.size()));
  }
}

void make_map(const std::string& log, const std::string& map, int argc, char** argv) {
  ConfigOf<SemanticMapConfig> config;
  for (int i = 0; i < argc; ++i) set_config_value(argv[i], config);
  std::remove(map.c_str());
  config.value.map = map;
  config.value.picture = map + ".png";
  LocalBus bus;
  SemanticMapNode node(config.value, bus);
  node.connect(bus);
  LogReader reader(log);
  while (auto event = reader.next()) {
    bus.inject(event->channel, event->bytes.data(), static_cast<int>(event->bytes.size()));
    bus.dispatch();
  }
  const auto cpu = [] { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; };
  const double start = cpu();
  node.finish();
  fmt::print("{} tiles, finish {:.2f} s of CPU\n", node.report().counters["tiles"], cpu() - start);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc >= 4 && std::strcmp(argv[1], "record") == 0) record(argv[2], argv[3]);
    if (argc >= 4 && std::strcmp(argv[1], "map") == 0) make_map(argv[2], argv[3], argc - 4, argv + 4);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  return 0;
}
