#pragma once

#include <cstdint>
#include <set>
#include <string>

#include "common/bus/bus_address.hpp"
#include "common/bus/bus_socket.hpp"
#include "common/bus/node.hpp"
#include "services/relay/bus_sender.hpp"
#include "services/relay/peer_links.hpp"
#include "services/relay/relay_config.hpp"

namespace curbstone::relay {

/// Joins the bus of this host with those of others. Who runs it watches two sockets: when bus_fd() is readable it calls
/// carry_out(), when peers_fd() is, carry_in().
class RelayNode final : public Node {
 public:
  /// `run`: another one at each start and on each host. Throws std::invalid_argument for a configuration that names no
  /// peers, std::runtime_error with one clear line when the bus or the port cannot be had.
  RelayNode(const RelayConfig& config, const BusAddress& bus, std::uint64_t run);

  void connect(Subscriber& bus) override { (void)bus; }  // it hears all channels, by a socket of its own
  void tick(std::int64_t now) override;
  [[nodiscard]] NodeReport report() const override;

  [[nodiscard]] int bus_fd() const { return bus_.fd(); }
  [[nodiscard]] int peers_fd() const { return peers_.fd(); }
  /// What was said on this host, to the peers.
  void carry_out();
  /// What peers have sent, to this host's bus.
  void carry_in(std::int64_t now);

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
