#pragma once

#include <curbstone/curb_lines_t.hpp>
#include <curbstone/lidar_points_t.hpp>
#include <curbstone/map_pose_t.hpp>
#include <curbstone/map_trajectory_t.hpp>
#include <curbstone/marking_lines_t.hpp>
#include <curbstone/semantic_tile_t.hpp>
#include <curbstone/service_status_t.hpp>
#include <curbstone/tile_index_t.hpp>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/bus/node.hpp"
#include "common/bus/single_sender.hpp"
#include "common/shell/latency.hpp"
#include "common/tile_sync/epoch_follower.hpp"
#include "common/tile_sync/tile_sync.hpp"
#include "services/viewer/cloud_intake.hpp"
#include "services/viewer/frames/page_feed.hpp"
#include "services/viewer/page_request.hpp"
#include "services/viewer/scan.hpp"
#include "services/viewer/state_json.hpp"
#include "services/viewer/store/services.hpp"
#include "services/viewer/viewer_config.hpp"
#include "services/viewer/wanted_channel.hpp"
#include "services/viewer/web/connections.hpp"

namespace curbstone::viewer {

/// Shows the map in browsers. It follows the tiles of semantic_map whether or not a page is open, so opening a page
/// causes no requests. It is read-only: the only messages it sends are requests for missed tiles. It is for people, so
/// unlike the other nodes it measures ages by the time of reception, not by the time of measurement.
class ViewerNode final : public Node {
 public:
  using PlaybackCommand = viewer::PlaybackCommand;
  /// What is shown, for the pages.
  struct Source {
    std::string kind = "live";  ///< or "map" (saved, never stale) or "replay"
    std::string title;
    std::function<void(const PlaybackCommand&)> on_order = {};  ///< empty: pages cannot control playback
  };
  ViewerNode(const ViewerConfig& config, Publisher& bus, web::Connections& connections, Source source);

  void connect(Subscriber& bus) override;
  void tick(std::int64_t now) override;
  [[nodiscard]] NodeReport report() const override;

  /// Discards all received data, as after a restart; the pages stay connected.
  void restart();
  /// The progress of the log that is played, for the pages.
  void set_playback(const Playback& playback) { playback_ = playback; }
  void set_title(const std::string& title) { source_.title = title; }

  /// The present state; valid until the next message.
  [[nodiscard]] frames::World world() const;
  [[nodiscard]] const std::optional<map_pose_t>& pose() const { return pose_; }
  /// Whether a consumer other than the pages wants the LiDAR's points.
  void want_scan(bool wanted) { scan_wanted_elsewhere_ = wanted; }

  void on(const semantic_tile_t& message);
  void on(const tile_index_t& message);
  void on(const map_pose_t& message);
  void on_localized(const map_pose_t& message);
  void on(const map_trajectory_t& message);
  void on(const curb_lines_t& message);
  void on(const marking_lines_t& message);
  void on(const service_status_t& message);
  void on(const lidar_points_t& message);

 private:
  struct Page {
    std::optional<frames::PageFeed> feed;  // empty until the page has reported what it has
    std::int64_t sent = 0;                 // us, the last frame
    LatencyWindow latency{64};
  };
  /// Whether a message of this epoch belongs to the present epoch, which the message may start.
  bool follow_epoch(std::int32_t epoch, EpochFollower::Source source);
  void enter_epoch(std::int32_t epoch);
  void forget_map();
  void take(const map_trajectory_t& message);
  template <class Message>
  void take_lines(const Message& message, store::BoxedLines<Message>& lines, const std::string& name);
  void receive(const web::Connections::Event& event);
  void receive(Page& page, const web::Connections::Event& event);
  void drawn(Page& page, std::uint32_t frame, std::int64_t at);
  void watch_scan();
  void watch_cloud();
  void send_frames();
  [[nodiscard]] State state_for(const Page& page) const;
  void heard() { bus_heard_ = now_; }
  [[nodiscard]] bool is_new_map() const;

  ViewerConfig config_;
  Publisher& bus_;
  web::Connections& connections_;
  Source source_;
  Subscriber* subscriber_ = nullptr;
  double run_ = 0;

  EpochFollower epochs_;
  TileFollower tiles_;
  store::LiveMap map_;
  frames::TileSteps steps_;
  store::CurbLines curbs_;
  store::MarkingLines markings_;
  store::ThinnedPath path_;
  std::int64_t left_ = 0;  // us, newest pose of the map that the present one replaced; 0: there was none
  store::Services services_;
  SingleSender lidar_;
  Scan scan_;
  WantedChannel<lidar_points_t> scan_points_{"LIDAR_POINTS", [this](const lidar_points_t& m) { on(m); }};
  bool scan_wanted_elsewhere_ = false;
  CloudIntake cloud_;
  std::vector<map_trajectory_t> held_;  // of an epoch that may begin
  std::optional<map_pose_t> pose_;
  std::optional<map_pose_t> localized_;
  std::optional<Playback> playback_;
  std::int64_t newest_utime_ = 0;  // us, of the newest points in any tile
  std::string services_json_;
  std::uint64_t services_number_ = 0;

  std::int64_t now_ = 0;  // us, of the last tick()
  std::int64_t bus_heard_ = 0;
  std::int64_t tile_heard_ = 0;
  std::int64_t index_heard_ = 0;
  double index_position_ = 0;  // s, in a log: its index ages in its own time, however slowly it is played
  std::int64_t pose_heard_ = 0;
  std::int64_t localized_heard_ = 0;
  std::int64_t last_request_ = 0;
  std::int64_t last_services_ = 0;
  std::map<web::PageId, Page> pages_;
  LatencyWindow latency_;
  Counters counters_;
};

}  // namespace curbstone::viewer
