#include "common/shell/service.hpp"
#include "config/sections.hpp"
#include "drivers/rslidar/packet_feed.hpp"

using namespace curbstone;

int main(int argc, char** argv) {
  std::unique_ptr<rslidar::PacketFeed> feed;
  return run_service<rslidar::RslidarConfig>(
      argc, argv, {"rslidar", kProcessSections, "RS-LiDAR-16 packets (UDP, or a capture) to LIDAR_POINTS"},
      [&feed](const rslidar::RslidarConfig& config, ServiceContext& context) -> std::unique_ptr<Node> {
        auto node = std::make_unique<rslidar::RslidarNode>(config, context.bus);
        feed = config.pcap.empty() ? rslidar::feed_from_network(config, *node, context.loop)
                                   : rslidar::feed_from_capture(config, *node, context.loop);
        return node;
      });
}
