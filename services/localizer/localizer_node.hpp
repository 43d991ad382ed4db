#pragma once

#include <curbstone/lidar_points_t.hpp>
#include <curbstone/odometry_t.hpp>
#include <deque>
#include <optional>

#include "common/bus/node.hpp"
#include "common/shell/latency.hpp"
#include "services/localizer/localizer_config.hpp"
#include "services/localizer/tracking/thinned_scan.hpp"
#include "services/localizer/tracking/tracker.hpp"
#include "services/mapper/scan/odometry_history.hpp"
#include "services/mapper/scan/scan_assembler.hpp"

namespace curbstone::localizer {

/// LIDAR_POINTS and ODOMETRY in, LOCALIZED_POSE out: where base_link is in the saved map, at the end of each revolution
/// (map_pose_t; its `map` is the saved map, its `epoch` that of the file). LOST: the pose is a guess. inlier_ratio: the
/// share of points that lie where the map has them. A revolution is processed once odometry has come to its end, or
/// when lidar time says that odometry is missing: the poses are a function of the two channels' sequences.
class LocalizerNode final : public Node {
 public:
  /// Throws MapStoreError if the map cannot be used.
  LocalizerNode(const LocalizerConfig& config, Publisher& bus);

  void connect(Subscriber& bus) override;
  void finish() override;
  [[nodiscard]] NodeReport report() const override;

  void on(const lidar_points_t& message);
  void on(const odometry_t& message);

 private:
  void queue(std::optional<mapper::scan::Scan> scan);
  void process_due(bool last_call);
  void process(const mapper::scan::Scan& scan);
  void begin(const mapper::scan::Scan& scan);
  [[nodiscard]] tracking::Motion motion_to(const mapper::scan::Scan& scan);
  void publish(const mapper::scan::Scan& scan, const tracking::PoseFit& fit, bool with_odometry);

  LocalizerConfig config_;
  Publisher& bus_;
  std::optional<fields::SavedMap> map_;
  std::int32_t epoch_ = 0;  // of the map
  mapper::scan::ScanAssembler assembler_;
  mapper::scan::OdometryHistory odometry_;
  tracking::ScanThinner thinner_;
  std::optional<tracking::Tracker> tracker_;  // from the first revolution with odometry on
  std::deque<mapper::scan::Scan> pending_;
  std::int64_t lidar_time_ = 0;  // us, newest LIDAR_POINTS
  std::int64_t last_end_ = 0;    // us, of the last revolution processed
  mapper::scan::Twist twist_;    // over the last two of them
  LatencyWindow latency_;
  Counters counters_;
};

}  // namespace curbstone::localizer
