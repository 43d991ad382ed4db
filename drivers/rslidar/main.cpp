#include "common/service.hpp"
#include "drivers/rslidar/packet_feed.hpp"

using namespace curbstone;

int main(int argc, char** argv) {
  std::unique_ptr<PacketFeed> feed;
  return run_service<RslidarConfig>(
      argc, argv, "rslidar", "RS-LiDAR-16 packets (UDP, or a capture) to LIDAR_POINTS",
      [&feed](const RslidarConfig& config, ServiceContext& context) -> std::unique_ptr<Node> {
        auto node = std::make_unique<RslidarNode>(config, context.bus);
        feed = config.pcap.empty() ? feed_from_network(config, *node, context.loop)
                                   : feed_from_capture(config, *node, context.loop);
        return node;
      });
}
