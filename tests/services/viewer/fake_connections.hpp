#pragma once

#include <string>
#include <utility>
#include <vector>

#include "services/viewer/web/connections.hpp"

namespace curbstone::viewer {

/// Pages without a browser: `events` is what they say next, `sent` what they were sent.
class FakeConnections final : public web::Connections {
 public:
  std::vector<Event> take_events() override { return std::exchange(events, {}); }
  void send(web::PageId page, web::Frame frame) override { sent.emplace_back(page, std::move(frame)); }
  void send_text(web::PageId page, std::string text) override { texts.emplace_back(page, std::move(text)); }
  [[nodiscard]] std::size_t queued(web::PageId) const override { return waiting; }
  [[nodiscard]] Counters counters() const override { return {}; }

  std::vector<Event> events;
  std::vector<std::pair<web::PageId, web::Frame>> sent;
  std::vector<std::pair<web::PageId, std::string>> texts;
  std::size_t waiting = 0;
};

}  // namespace curbstone::viewer
