#pragma once

#include <curbstone/lidar_points_t.hpp>
#include <curbstone/odometry_t.hpp>
#include <deque>
#include <memory>
#include <optional>

#include "common/bus/node.hpp"
#include "common/bus/single_sender.hpp"
#include "common/shell/latency.hpp"
#include "services/localizer/localizer_config.hpp"
#include "services/localizer/search/global_localizer.hpp"
#include "services/localizer/tracking/clock_step_bridge.hpp"
#include "services/localizer/tracking/paint_finder.hpp"
#include "services/localizer/tracking/pose_tracker.hpp"
#include "services/localizer/tracking/thinned_scan.hpp"
#include "services/mapper/scan/lidar_clock.hpp"
#include "services/mapper/scan/odometry_history.hpp"
#include "services/mapper/scan/scan_assembler.hpp"
#include "services/semantic_map/store/map_store.hpp"

namespace curbstone::localizer {

/// The localizer's node: LIDAR_POINTS and ODOMETRY in, LOCALIZED_POSE out. The pose is that of base_link in the saved
/// map at the end of each revolution (map_pose_t; its `map` is the saved map, its `epoch` the epoch of the file). LOST:
/// the pose is a guess. inlier_ratio: the share of points that match the map. A revolution is processed once odometry
/// has reached its end, or once lidar time shows that odometry is missing: the poses are a function of the two
/// channels' sequences. The whole map is searched while the vehicle is lost, and at the start if no start pose is
/// configured. Before anything is known, the pose is the map's origin, marked LOST, with a covariance to match.
class LocalizerNode final : public Node {
 public:
  /// Throws MapStoreError if the map cannot be used, ConfigError if the start is not a valid pose.
  LocalizerNode(const LocalizerConfig& config, Publisher& bus);

  void connect(Subscriber& bus) override;
  void clock_was_set(std::int64_t by) override { bridge_.clock_was_set(static_cast<double>(by) * 1e-6); }
  void finish() override;
  [[nodiscard]] NodeReport report() const override;

  void on(const lidar_points_t& message);
  void on(const odometry_t& message);

 private:
  [[nodiscard]] std::optional<semantic_map::tile::MapTile> read(TileKey key);
  void queue(std::optional<mapper::scan::Scan> scan);
  void process_due();
  void process_next();
  void process(const mapper::scan::Scan& scan);
  void begin(const mapper::scan::Scan& scan);
  [[nodiscard]] tracking::Motion motion_to(const mapper::scan::Scan& scan);
  [[nodiscard]] std::optional<Pose> motion_over_clock_step(const mapper::scan::Scan& scan);
  [[nodiscard]] std::unique_ptr<tracking::PoseTracker> tracker_from(const tracking::PoseBelief& start) const;
  void search_globally(const mapper::scan::Scan& scan, const std::vector<Eigen::Vector3d>& points,
                       const tracking::Motion& motion);
  [[nodiscard]] bool lost() const { return !tracker_ || tracker_->lost(); }
  struct Answer {
    Pose T_map_base = Pose::Identity();
    tracking::Matrix6 covariance;
    tracking::PoseFit fit;
  };
  [[nodiscard]] Answer answer(const tracking::PoseFit& fit) const;
  void publish(const mapper::scan::Scan& scan, const Answer& answer, bool with_odometry);

  LocalizerConfig config_;
  Publisher& bus_;
  semantic_map::store::MapReader file_;
  bool is_checked_ = false;   // every tile was read once
  bool is_replaced_ = false;  // the file holds another drive now
  std::optional<fields::SavedMap> map_;
  std::int32_t epoch_ = 0;  // of the map
  SingleSender lidar_;
  mapper::scan::LidarClock clock_;
  mapper::scan::ScanAssembler assembler_;
  mapper::scan::OdometryHistory odometry_;
  tracking::ScanThinner thinner_;
  tracking::PaintFinder paint_;
  bool slides_ = false;  // the last revolution fits the map, which does not tell all of the place
  std::unique_ptr<tracking::PoseTracker> tracker_;  // null until there is a start pose
  search::GlobalLocalizer global_localizer_;
  bool begun_ = false;  // since the first revolution with odometry
  std::deque<mapper::scan::Scan> pending_;
  std::int64_t lidar_time_ = 0;  // us, newest LIDAR_POINTS
  std::int64_t last_end_ = 0;    // us, end of the last revolution processed
  mapper::scan::Twist twist_;    // over the last two revolutions
  tracking::ClockStepBridge bridge_;
  LatencyWindow latency_;
  Counters counters_;
};

}  // namespace curbstone::localizer
