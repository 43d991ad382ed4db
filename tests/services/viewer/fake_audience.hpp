#pragma once

#include <string>
#include <utility>
#include <vector>

#include "services/viewer/web/audience.hpp"

namespace curbstone::viewer {

/// Pages without a browser: `events` is what they say next, `sent` what they were sent.
class FakeAudience final : public web::Audience {
 public:
  std::vector<Event> take_events() override { return std::exchange(events, {}); }
  void send(web::PageId page, web::Frame frame) override { sent.emplace_back(page, std::move(frame)); }
  void say(web::PageId page, std::string text) override { said.emplace_back(page, std::move(text)); }
  [[nodiscard]] std::size_t queued(web::PageId) const override { return waiting; }
  [[nodiscard]] Counters counters() const override { return {}; }

  std::vector<Event> events;
  std::vector<std::pair<web::PageId, web::Frame>> sent;
  std::vector<std::pair<web::PageId, std::string>> said;
  std::size_t waiting = 0;
};

}  // namespace curbstone::viewer
