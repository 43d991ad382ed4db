#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "common/bus/counters.hpp"
#include "services/viewer/foxglove/feed.hpp"
#include "services/viewer/web/audience.hpp"

namespace curbstone::viewer::foxglove {

/// Foxglove's clients: tells each what there is, and sends what it subscribed to, the present state first. They can
/// order nothing. A client gets no more than it takes: while kMostQueued bytes wait for it nothing is made for it, and
/// nothing large while kMostForLarge wait or when it has had kMostASecond. One thread.
class Door {
 public:
  static constexpr std::size_t kMostQueued = 4'000'000;
  static constexpr std::size_t kMostForLarge = 100'000;
  /// Of a client, on average: whoever subscribes again and again would keep the node busy with maps.
  static constexpr std::size_t kMostASecond = 20'000'000;

  /// `clients` must outlive this. `session`: another one for each run of the process.
  Door(web::Audience& clients, std::string session) : clients_(clients), session_(std::move(session)) {}

  /// Hears the clients and sends what is due. `now`: us since the Unix epoch.
  void tick(const World& world, std::int64_t now);

  /// Whether a client subscribed to what costs the bus something: the LiDAR's points.
  [[nodiscard]] bool wants(Topic topic) const;
  /// foxglove.clients, foxglove.messages; refused.foxglove (requests that mean nothing); and those of the connections.
  [[nodiscard]] Counters counters() const;

 private:
  struct Client {
    Feed feed{Feed::For::kClient};
    std::map<std::uint32_t, std::uint32_t> subscriptions;  // by channel: the client's id
    std::size_t services = 0;                              // announced to it
    std::int64_t large_sent = 0;                           // us
    std::int64_t large_pause = 0;                          // us from then on
  };
  void serve(web::PageId id, Client& client, const World& world, std::int64_t now);
  void hear(const web::Audience::Event& event);
  void hear(web::PageId id, Client& client, const std::string& text);
  void introduce(web::PageId id, Client& client, const StatusBook& status);
  [[nodiscard]] static bool is_known(std::uint32_t channel, const Client& client);

  web::Audience& clients_;
  std::string session_;
  std::map<web::PageId, Client> known_;
  Counters counters_;
};

}  // namespace curbstone::viewer::foxglove
