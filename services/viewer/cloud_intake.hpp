#pragma once

#include <cstdint>
#include <curbstone/map_points_t.hpp>
#include <curbstone/map_pose_t.hpp>
#include <curbstone/tile_index_t.hpp>
#include <curbstone/voted_points_t.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/counters.hpp"
#include "common/tile_sync/tile_sync.hpp"
#include "services/viewer/frames/cloud_feed.hpp"
#include "services/viewer/store/dense_cloud.hpp"
#include "services/viewer/wanted_channel.hpp"

namespace curbstone::viewer {

/// Receives the dense cloud for the pages that ask for it: MAP_POINTS, and VOTED_POINTS while one of them shows
/// saliencies. Only while a page asks is anything subscribed to (WantedChannel) or kept. Tiles that were mapped before
/// are requested, a few at a time, the nearest first. One thread.
class CloudIntake {
 public:
  static constexpr std::size_t kRequested = 4;             ///< tiles
  static constexpr std::int64_t kRequestPeriod = 200'000;  ///< us

  /// `requester`: the name in TILE_REQUEST.
  explicit CloudIntake(const std::string& requester)
      : records_(requester, "MAP_POINTS"), revisions_(requester, "VOTED_POINTS") {}

  /// What all pages together want, added up page by page.
  struct Wish {
    bool wide = false;
    bool saliency = false;
    std::vector<std::pair<double, double>> cuts;  ///< m in map
    void add(const frames::CloudWish& wish);
    [[nodiscard]] bool any() const { return wide || !cuts.empty(); }
  };
  /// Call it regularly. `bus`: where to subscribe, null before it is connected; `pose`: of the vehicle, if it is known.
  void tick(std::int64_t now, const Wish& wish, std::int32_t epoch, const std::optional<map_pose_t>& pose,
            Subscriber* bus, Publisher& out);
  /// Of any channel.
  void on(const tile_index_t& message);
  void on(const map_points_t& message);
  void on(const voted_points_t& message);
  /// Discards all.
  void forget();

  [[nodiscard]] const store::DenseCloud& cloud() const { return cloud_; }
  /// refused.map_points, refused.voted_points: invalid messages.
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  void look(const Wish& wish, std::int32_t epoch, const std::optional<map_pose_t>& pose);
  void ask(std::int64_t now, const Wish& wish, Publisher& out);
  void note(store::DenseCloud::Put put, TileKey key, std::int32_t announced);
  TileFollower& follower() { return has_saliency_ ? revisions_ : records_; }

  store::DenseCloud cloud_;
  TileFollower records_;
  TileFollower revisions_;
  bool is_wanted_ = false;
  bool has_saliency_ = false;  // from VOTED_POINTS
  WantedChannel<map_points_t> points_{"MAP_POINTS", [this](const map_points_t& m) { on(m); }};
  WantedChannel<voted_points_t> voted_{"VOTED_POINTS", [this](const voted_points_t& m) { on(m); }};
  std::optional<std::int32_t> epoch_;
  std::int64_t last_request_ = 0;  // us
  Counters counters_;
};

}  // namespace curbstone::viewer
