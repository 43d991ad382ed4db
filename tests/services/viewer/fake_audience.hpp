#pragma once

#include <utility>
#include <vector>

#include "services/viewer/web/audience.hpp"

namespace curbstone::viewer {

/// Pages without a browser: `events` is what they say next, `sent` what they were sent.
class FakeAudience final : public web::Audience {
 public:
  std::vector<Event> take_events() override { return std::exchange(events, {}); }
  void send(web::PageId page, web::Frame frame) override { sent.emplace_back(page, std::move(frame)); }
  [[nodiscard]] Counters counters() const override { return {}; }

  std::vector<Event> events;
  std::vector<std::pair<web::PageId, web::Frame>> sent;
};

}  // namespace curbstone::viewer
