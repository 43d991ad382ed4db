#pragma once

#include <cstdint>
#include <curbstone/map_pose_t.hpp>
#include <optional>

#include "common/bus/counters.hpp"
#include "common/geometry/geometry.hpp"
#include "common/geometry/pose_covariance.hpp"
#include "services/ekf/base/ekf_config.hpp"

namespace curbstone::ekf::inputs {

/// Motion of base_link between two times, as the mapper saw it. It does not depend on the map's origin or on jumps of
/// the map before.
struct MapIncrement {
  std::int64_t begin = 0;               ///< us
  std::int64_t utime = 0;               ///< us, end
  Pose T_begin_end = Pose::Identity();  ///< base_link at the end, in base_link at the beginning
  PoseCovariance covariance;            ///< in base_link's axes at the end
};

/// Makes increments from MAP_POSEs that are at least `map.baseline` apart: the speed between two neighbouring
/// revolutions is mostly the noise of both. Uses only registered poses of one epoch, and none while the mapper reports
/// that it is lost: a pose after relocalisation lies elsewhere than the last one and may be wrong. An axis that the
/// mapper left to odometry gets no weight, or the filter would be fed its own estimate.
///
/// Counters: refused.lost.map, refused.not_registered.map, refused.uncertain.map (its 1 sigma exceeds 1 m or rad),
/// refused.not_finite.map; map.epochs (jumps of the map that were not taken for motion).
class MapIncrements {
 public:
  explicit MapIncrements(const base::MapFusionConfig& config) : config_(config) {}
  /// Returns the increment that ends with this pose, if there is one.
  [[nodiscard]] std::optional<MapIncrement> add(const map_pose_t& message);
  /// The next pose starts a new increment.
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
