#pragma once

#include <cstdint>
#include <set>
#include <string>

#include "common/bus/node.hpp"
#include "common/bus/socket/bus_address.hpp"
#include "common/bus/socket/bus_socket.hpp"
#include "services/relay/bus_sender.hpp"
#include "services/relay/peer_links.hpp"
#include "services/relay/relay_config.hpp"

namespace curbstone::relay {

/// Connects the bus of this host with those of other hosts. The caller watches two sockets: it calls forward_to_peers()
/// when bus_fd() is readable, and forward_to_bus() when peers_fd() is readable.
class RelayNode final : public Node {
 public:
  /// `run`: differs at each start and on each host. Throws std::invalid_argument for a configuration without peers,
  /// std::runtime_error with one clear line if the bus or the port is not available.
  RelayNode(const RelayConfig& config, const BusAddress& bus, std::uint64_t run);

  void connect(Subscriber& bus) override { (void)bus; }  // it hears all channels, by a socket of its own
  void tick(std::int64_t now) override;
  [[nodiscard]] NodeReport report() const override;

  [[nodiscard]] int bus_fd() const { return bus_.fd(); }
  [[nodiscard]] int peers_fd() const { return peers_.fd(); }
  /// Sends this host's messages to the peers.
  void forward_to_peers();
  /// Publishes the peers' messages on this host's bus.
  void forward_to_bus(std::int64_t now);

 private:
  std::set<std::string, std::less<>> except_;
  mutable BusSocket bus_;
  BusSender sender_;
  PeerLinks peers_;
  std::int64_t start_ = 0;  // us: the first tick
  std::int64_t now_ = 0;
  std::int64_t last_sign_ = 0;
  Counters counters_;
};

}  // namespace curbstone::relay
