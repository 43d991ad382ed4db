#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "common/bus/counters.hpp"
#include "services/viewer/foxglove/feed.hpp"
#include "services/viewer/web/connections.hpp"

namespace curbstone::viewer::foxglove {

/// The server side of the Foxglove protocol: advertises the channels to each client and sends what the client
/// subscribed to, the present state first. Clients cannot command anything. Back-pressure: while kMaxQueued bytes are
/// queued for a client, no message is made for it; while kMaxQueuedForLarge bytes are queued, or the client is above
/// kMaxPerSecond, no large message is made. One thread.
class Endpoint {
 public:
  static constexpr std::size_t kMaxQueued = 4'000'000;
  static constexpr std::size_t kMaxQueuedForLarge = 100'000;
  /// Bytes per second and client, averaged. Without it, repeated subscriptions would keep the node busy encoding maps.
  static constexpr std::size_t kMaxPerSecond = 20'000'000;

  /// `clients` must outlive this. `session`: unique for each run of the process.
  Endpoint(web::Connections& clients, std::string session) : clients_(clients), session_(std::move(session)) {}

  /// Handles the clients' requests and sends the messages that are due. `now`: us since the Unix epoch.
  void tick(const World& world, std::int64_t now);

  /// Whether any client subscribed to `topic`. The node subscribes to costly bus channels, such as the LiDAR's points,
  /// only then.
  [[nodiscard]] bool wants(Topic topic) const;
  /// foxglove.clients, foxglove.messages; refused.foxglove (invalid requests); and the counters of the connections.
  [[nodiscard]] Counters counters() const;

 private:
  struct Client {
    Feed feed{Feed::For::kClient};
    std::map<std::uint32_t, std::uint32_t> subscriptions;  // by channel: the client's id of the subscription
    std::size_t services = 0;                              // how many were announced to the client
    std::int64_t large_sent = 0;                           // us, of the last large message
    std::int64_t large_pause = 0;                          // us after large_sent without another large message
  };
  void serve(web::PageId id, Client& client, const World& world, std::int64_t now);
  void receive(const web::Connections::Event& event);
  void receive(web::PageId id, Client& client, const std::string& text);
  void advertise_services(web::PageId id, Client& client, const StatusHistory& status);
  [[nodiscard]] static bool is_known(std::uint32_t channel, const Client& client);

  web::Connections& clients_;
  std::string session_;
  std::map<web::PageId, Client> known_;
  Counters counters_;
};

}  // namespace curbstone::viewer::foxglove
