#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "common/shell/event_loop.hpp"
#include "drivers/lidar/lidar_node.hpp"
#include "drivers/lidar/sources/udp_source.hpp"

namespace curbstone::lidar {

/// Owns what brings a node its packets: sockets or a capture file. Node and loop must outlive it.
class PacketFeed {
 public:
  virtual ~PacketFeed() = default;
};

/// From the network, until the process ends. An interface that is not there yet is a fault of the node, and is tried
/// again. Throws std::runtime_error, one line, for what does not mend itself.
[[nodiscard]] std::unique_ptr<PacketFeed> feed_from_network(const LidarConfig& config, LidarNode& node,
                                                            EventLoop& loop);

/// From a capture at its own pace times `pcap_rate`. At its end it begins anew with `pcap_repeat`; else the loop is
/// stopped, and so the process ends. Packets to the configured ports are used, or, where none is
/// configured, those of LiDARs to any port. Throws std::runtime_error, one line. So does the loop where the file is
/// damaged.
[[nodiscard]] std::unique_ptr<PacketFeed> feed_from_capture(const LidarConfig& config, LidarNode& node,
                                                            EventLoop& loop);

/// The same once, as fast as possible, without a process. Finishes the node. Returns the number of packets.
std::int64_t feed_whole_capture(const LidarConfig& config, LidarNode& node);

}  // namespace curbstone::lidar
