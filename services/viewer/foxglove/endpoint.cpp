#include "services/viewer/foxglove/endpoint.hpp"

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <utility>

#include "common/bus/levels.hpp"
#include "services/viewer/foxglove/wire.hpp"

namespace curbstone::viewer::foxglove {

void Endpoint::tick(const World& world, std::int64_t now) {
  for (const web::Connections::Event& event : clients_.take_events()) receive(event);
  for (auto& [id, client] : known_) {
    advertise_services(id, client, world.status);
    serve(id, client, world, now);
  }
}

void Endpoint::serve(web::PageId id, Client& client, const World& world, std::int64_t now) {
  const std::size_t queued = clients_.queued(id);
  if (queued > kMaxQueued) return;
  const bool takes_large = queued <= kMaxQueuedForLarge && std::abs(now - client.large_sent) >= client.large_pause;
  std::size_t bytes = 0;
  for (const Message& message : client.feed.due(world, now, takes_large)) {
    const std::uint32_t subscription = client.subscriptions.at(message.channel);
    clients_.send(id,
                  std::make_shared<const std::vector<std::uint8_t>>(data_frame(subscription, now, message.payload)));
    counters_.add("foxglove.messages");
    bytes += message.payload.size();
  }
  if (!takes_large || bytes == 0) return;
  client.large_sent = now;
  client.large_pause = static_cast<std::int64_t>(bytes * 1'000'000 / kMaxPerSecond);
}

void Endpoint::receive(const web::Connections::Event& event) {
  using Kind = web::Connections::Event::Kind;
  if (event.kind == Kind::kConnected) {
    known_.try_emplace(event.page);
    clients_.send_text(event.page, server_info("Curbstone", session_));
    clients_.send_text(event.page, advertise(fixed_channels()));
  }
  if (event.kind == Kind::kDisconnected) known_.erase(event.page);
  const auto client = known_.find(event.page);
  if (event.kind == Kind::kMessage && client != known_.end()) receive(event.page, client->second, event.text);
}

void Endpoint::receive(web::PageId id, Client& client, const std::string& text) {
  const auto request = parse_request(text);
  if (!request) {
    counters_.add("refused.foxglove");
    return clients_.send_text(id, warning("This server takes subscribe and unsubscribe, and nothing else."));
  }
  for (const auto& wanted : request->subscribe) {
    if (!is_known(wanted.channel, client)) {
      counters_.add("refused.foxglove");
      clients_.send_text(id, warning("There is no channel " + std::to_string(wanted.channel) + "."));
      continue;
    }
    client.subscriptions[wanted.channel] = wanted.id;
    client.feed.subscribe(wanted.channel);
  }
  for (const std::uint32_t subscription : request->unsubscribe) {
    const auto found = std::find_if(client.subscriptions.begin(), client.subscriptions.end(),
                                    [&](const auto& entry) { return entry.second == subscription; });
    if (found == client.subscriptions.end()) continue;
    client.feed.unsubscribe(found->first);
    client.subscriptions.erase(found);
  }
}

/// Advertises the processes first heard since the last call.
void Endpoint::advertise_services(web::PageId id, Client& client, const StatusHistory& status) {
  std::vector<Channel> new_channels;
  for (; client.services < status.services().size(); ++client.services)
    new_channels.push_back(status_channel(client.services, status.services()[client.services].topic));
  if (!new_channels.empty()) clients_.send_text(id, advertise(new_channels));
}

bool Endpoint::is_known(std::uint32_t channel, const Client& client) {
  const auto& fixed = fixed_channels();
  return std::any_of(fixed.begin(), fixed.end(), [&](const Channel& known) { return known.id == channel; }) ||
         (channel >= kFirstStatus && channel - kFirstStatus < client.services);
}

bool Endpoint::wants(Topic topic) const {
  return std::any_of(known_.begin(), known_.end(), [&](const auto& entry) { return entry.second.feed.wants(topic); });
}

Counters Endpoint::counters() const {
  Counters counters = counters_;
  set_level(counters, "foxglove.clients", static_cast<std::int64_t>(known_.size()));
  counters.add(clients_.counters());
  return counters;
}

}  // namespace curbstone::viewer::foxglove
