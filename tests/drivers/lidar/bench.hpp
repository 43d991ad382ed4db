#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "common/bus/local_bus.hpp"
#include "drivers/lidar/lidar_node.hpp"
#include "drivers/lidar/models/robosense/magic.hpp"
#include "drivers/lidar/sources/pcap_source.hpp"

namespace curbstone::lidar {

/// A node on a bus of its own, and what it said. Its host's clock is synchronised unless the test says otherwise.
struct Bench {
  explicit Bench(const LidarConfig& config = {}) : node(config, bus, [this] { return host_is_synchronised; }) {
    node.connect(bus);
    bus.subscribe<lidar_points_t>(config.channel, [this](const lidar_points_t& m) { points.push_back(m); });
    bus.subscribe<raw_packet_t>(config.raw_channel, [this](const raw_packet_t& m) { raw.push_back(m); });
  }
  void send(std::span<const std::uint8_t> bytes, std::int64_t received, int port = models::robosense::kMsopPort) {
    node.on_packet(received, port, bytes);
    bus.dispatch();
  }
  void finish() {
    node.finish();
    bus.dispatch();
  }
  [[nodiscard]] std::int64_t count(const char* name) const { return node.report().counters[name]; }
  /// Of all packets that were refused.
  [[nodiscard]] std::int64_t refused() const {
    std::int64_t sum = 0;
    const NodeReport report = node.report();
    for (const auto& [name, value] : report.counters.values()) sum += name.starts_with("refused.") ? value : 0;
    return sum;
  }

  LocalBus bus;
  bool host_is_synchronised = true;
  LidarNode node;
  std::vector<lidar_points_t> points;
  std::vector<raw_packet_t> raw;
};

/// A packet of a recording, which a test may change.
struct RecordedPacket {
  std::int64_t received = 0;
  int port = 0;
  std::vector<std::uint8_t> bytes;
};

inline std::vector<RecordedPacket> recording(const std::string& file) {
  std::vector<RecordedPacket> packets;
  sources::PcapSource source(file);
  for (auto packet = source.next(); packet; packet = source.next())
    packets.push_back({packet->received, packet->port, {packet->bytes.begin(), packet->bytes.end()}});
  return packets;
}

}  // namespace curbstone::lidar
