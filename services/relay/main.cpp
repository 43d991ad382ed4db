#include <random>

#include "common/shell/service.hpp"
#include "common/time/clock.hpp"
#include "config/sections.hpp"
#include "services/relay/relay_node.hpp"

int main(int argc, char** argv) {
  using namespace curbstone;
  return run_service<relay::RelayConfig>(
      argc, argv, {"relay", kProcessSections, "Joins the bus of this host with those of other hosts"},
      [](const relay::RelayConfig& config, ServiceContext& context) -> std::unique_ptr<Node> {
        const auto address = parse_bus_url(context.url);
        if (!address) throw std::runtime_error(context.url + " is no bus that other hosts can join");
        std::random_device random;
        const std::uint64_t run = std::uint64_t{random()} << 32U | random();
        auto node = std::make_unique<relay::RelayNode>(config, *address, run);
        context.loop.watch(node->bus_fd(), [node = node.get()] { node->forward_to_peers(); });
        context.loop.watch(node->peers_fd(), [node = node.get()] { node->forward_to_bus(wall_clock()); });
        return node;
      });
}
