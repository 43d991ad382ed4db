#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "common/event_loop.hpp"
#include "drivers/rslidar/pcap_source.hpp"
#include "drivers/rslidar/rslidar_node.hpp"
#include "drivers/rslidar/udp_source.hpp"

namespace curbstone {

/// Brings a node its packets: whatever the process owns besides the node.
class PacketFeed {
 public:
  virtual ~PacketFeed() = default;
};

/// From the network, until the process ends. Throws std::runtime_error, one line.
[[nodiscard]] std::unique_ptr<PacketFeed> feed_from_network(const RslidarConfig& config, RslidarNode& node,
                                                            EventLoop& loop);

/// From a capture at its own pace times `pcap_rate`; at its end the loop is stopped: the process ends. Only packets to
/// the two configured ports are used. Throws std::runtime_error, one line; so does the loop where the file is damaged.
[[nodiscard]] std::unique_ptr<PacketFeed> feed_from_capture(const RslidarConfig& config, RslidarNode& node,
                                                            EventLoop& loop);

/// The same as fast as possible, without a process. Returns the number of packets.
std::int64_t feed_whole_capture(const RslidarConfig& config, RslidarNode& node);

}  // namespace curbstone
