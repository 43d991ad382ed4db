#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "common/bus/local_bus.hpp"
#include "common/log/log_reader.hpp"
#include "services/viewer/foxglove_state.hpp"
#include "services/viewer/viewer_node.hpp"

namespace curbstone::map_export::mcap {

/// Plays a log to produce the messages that curbstone-viewer would have sent to a Foxglove client during the recording,
/// at the log's own rate. Memory is that of the viewer, which is bounded. One thread.
class FoxgloveLog {
 public:
  explicit FoxgloveLog(const viewer::ViewerConfig& config);

  /// The messages that result from the event, in order.
  [[nodiscard]] std::vector<viewer::foxglove::Message> take(const LogEvent& event);
  /// The remaining messages that were not due yet.
  [[nodiscard]] std::vector<viewer::foxglove::Message> finish();

  /// In the order of their first message, as for the channels from kFirstStatus on.
  [[nodiscard]] const std::vector<viewer::foxglove::StatusHistory::Service>& services() const {
    return state_.status().services();
  }
  [[nodiscard]] bool has_map() const { return node_.world().map.size() > 0; }
  /// us since the Unix epoch: the sending time of the last call's messages.
  [[nodiscard]] std::int64_t now() const { return now_; }
  /// Counts of invalid messages in the log.
  [[nodiscard]] Counters counters() const;

 private:
  /// No connections: a file has no pages.
  class NoPages final : public viewer::web::Connections {
   public:
    std::vector<Event> take_events() override { return {}; }
    void send(viewer::web::PageId, viewer::web::Frame) override {}
    void send_text(viewer::web::PageId, std::string) override {}
    [[nodiscard]] std::size_t queued(viewer::web::PageId) const override { return 0; }
    [[nodiscard]] Counters counters() const override { return {}; }
  };
  [[nodiscard]] std::vector<viewer::foxglove::Message> tick(std::int64_t now);

  VehicleConfig vehicle_;
  NoPages pages_;
  LocalBus bus_;
  viewer::ViewerNode node_;
  viewer::FoxgloveState state_;
  viewer::foxglove::Feed feed_{viewer::foxglove::Feed::For::kFile};
  std::size_t subscribed_services_ = 0;
  std::int64_t now_ = 0;     // us
  std::int64_t ticked_ = 0;  // us
};

}  // namespace curbstone::map_export::mcap
