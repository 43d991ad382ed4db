#pragma once

#include <cstdint>
#include <curbstone/map_pose_t.hpp>
#include <optional>

#include "common/bus/counters.hpp"
#include "common/geometry/geometry.hpp"
#include "common/geometry/pose_covariance.hpp"
#include "services/ekf/base/ekf_config.hpp"

namespace curbstone::ekf::inputs {

/// How base_link moved from one time to another, as the mapper saw it. Where the map is, and where it jumped to before,
/// does not show in it.
struct MapIncrement {
  std::int64_t begin = 0;               ///< us
  std::int64_t utime = 0;               ///< us, its end
  Pose T_begin_end = Pose::Identity();  ///< base_link at its end, seen from base_link at its beginning
  PoseCovariance covariance;            ///< in base_link's axes at its end
};

/// Makes increments of MAP_POSEs that are at least `map.baseline` apart: what two neighbouring revolutions say about
/// speed is mostly the noise of both. Only registered poses of one epoch are taken, and none while the mapper says that
/// it is lost: a pose where it was just found again lies elsewhere than the last one, and may be wrong. An axis that
/// the mapper left to odometry is given no weight, or the filter would be fed its own word.
///
/// Counters: refused.lost.map, refused.not_registered.map, refused.uncertain.map (it claims less than to know it to
/// 1 m or rad), refused.not_finite.map; map.epochs (jumps of the map that were not taken for motion).
class MapIncrements {
 public:
  explicit MapIncrements(const base::MapFusionConfig& config) : config_(config) {}
  /// The increment that ends with this pose, if one does.
  [[nodiscard]] std::optional<MapIncrement> add(const map_pose_t& message);
  /// The next pose begins anew.
  void interrupt() { last_.reset(); }
  [[nodiscard]] const Counters& counters() const { return counters_; }

 private:
  struct Last {
    std::int64_t utime;
    std::int32_t epoch;
    Pose T_map_base;
    PoseCovariance covariance;  // in base_link's axes
  };
  base::MapFusionConfig config_;
  std::optional<Last> last_;
  Counters counters_;
};

}  // namespace curbstone::ekf::inputs
