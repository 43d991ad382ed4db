#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "common/shell/event_loop.hpp"
#include "drivers/lidar/lidar_node.hpp"
#include "drivers/lidar/sources/udp_source.hpp"

namespace curbstone::lidar {

/// Owns a node's packet source: sockets or a capture file. Node and loop must outlive it.
class PacketFeed {
 public:
  virtual ~PacketFeed() = default;
};

/// Feeds from the network, until the process ends. A missing interface or a port that is taken is a fault of the node,
/// and is retried. Throws std::runtime_error with a one-line message for errors that retrying does not fix.
[[nodiscard]] std::unique_ptr<PacketFeed> feed_from_network(const LidarConfig& config, LidarNode& node,
                                                            EventLoop& loop);

/// Feeds from a capture at its own pace times `pcap_rate`. At its end it restarts with `pcap_repeat`; otherwise the
/// loop is stopped, which ends the process. Uses packets to the configured ports or, if none is configured, those of
/// LiDARs to any port. Throws std::runtime_error with a one-line message; so does the loop if the file is damaged.
[[nodiscard]] std::unique_ptr<PacketFeed> feed_from_capture(const LidarConfig& config, LidarNode& node,
                                                            EventLoop& loop);

/// Feeds a capture once, as fast as possible, without a process. Finishes the node. Returns the number of packets.
std::int64_t feed_whole_capture(const LidarConfig& config, LidarNode& node);

}  // namespace curbstone::lidar
