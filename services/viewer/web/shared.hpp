#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <mutex>
#include <string_view>
#include <utility>
#include <vector>

#include "common/bus/counters.hpp"
#include "services/viewer/web/connections.hpp"
#include "services/viewer/web/host_rules.hpp"
#include "services/viewer/web/web_server.hpp"

namespace curbstone::viewer::web {

inline constexpr std::size_t kMaxEvents = 4000;  ///< not taken by the node yet, which takes them every 20 ms

/// State shared by the connections. The node also uses the events and counters, so they are under the lock.
struct Shared {
  Shared(const WebSettings& its_settings, HostRules its_rules) : settings(its_settings), rules(std::move(its_rules)) {}

  void count(std::string_view name, std::int64_t amount = 1) {
    const std::scoped_lock lock(mutex);
    counters.add(name, amount);
  }
  bool post_event(Connections::Event event) {
    const std::scoped_lock lock(mutex);
    if (events.size() >= kMaxEvents && event.kind == Connections::Event::Kind::kMessage) return false;
    events.push_back(std::move(event));
    return true;
  }

  void queue(PageId page, std::size_t bytes) {
    const std::scoped_lock lock(mutex);
    queued[page] += bytes;
  }
  /// The bytes were sent or dropped.
  void unqueue(PageId page, std::size_t bytes) {
    const std::scoped_lock lock(mutex);
    const auto it = queued.find(page);
    if (it == queued.end()) return;
    it->second -= std::min(bytes, it->second);
    if (it->second == 0) queued.erase(it);
  }

  const WebSettings settings;
  const HostRules rules;
  std::size_t connections = 0;  // used by the web thread only
  std::mutex mutex;
  Counters counters;
  std::map<PageId, std::size_t> queued;  // bytes
  std::vector<Connections::Event> events;
};

/// Counts a connection while it exists.
class ConnectionSlot {
 public:
  explicit ConnectionSlot(Shared& shared) : shared_(shared) { ++shared_.connections; }
  ~ConnectionSlot() { --shared_.connections; }
  ConnectionSlot(const ConnectionSlot&) = delete;
  ConnectionSlot& operator=(const ConnectionSlot&) = delete;

 private:
  Shared& shared_;
};

}  // namespace curbstone::viewer::web
