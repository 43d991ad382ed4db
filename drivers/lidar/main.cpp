#include <cstdio>

#include "common/shell/service.hpp"
#include "config/sections.hpp"
#include "drivers/lidar/packet_feed.hpp"

using namespace curbstone;

int main(int argc, char** argv) {
  std::unique_ptr<lidar::PacketFeed> feed;
  return run_service<lidar::LidarConfig>(
      argc, argv, {"lidar", kProcessSections, "RS-LiDAR-16 packets (UDP, or a capture) to LIDAR_POINTS"},
      [&feed](const lidar::LidarConfig& config, ServiceContext& context) -> std::unique_ptr<Node> {
        auto node = std::make_unique<lidar::LidarNode>(config, context.bus);
        // A full disk behind stderr must not end the process.
        node->print_to([](const std::string& text) { (void)std::fputs(("lidar: " + text + "\n").c_str(), stderr); });
        feed = config.pcap.empty() ? lidar::feed_from_network(config, *node, context.loop)
                                   : lidar::feed_from_capture(config, *node, context.loop);
        return node;
      });
}
