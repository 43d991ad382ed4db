#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "services/mapper/pose_graph/atlas.hpp"

namespace curbstone::mapper {

/// A scan's end, as the map has it.
struct TrajectoryPoint {
  std::int64_t utime;  ///< us
  std::int32_t revolution;
  Pose T_map_base;
  std::int32_t node = 0;                           ///< of the atlas, that the vehicle was at
  std::optional<Pose> T_odom_base = std::nullopt;  ///< what odometry said of it, so far as that is known
};

/// The drive's poses, each kept as it is seen from a keyframe: when a loop is closed they move with the keyframes.
/// Knows what odometry said along the last of them, so that the two accounts of the drive can be compared. Pure; one
/// thread.
class Trajectory {
 public:
  /// A scan that was tracked.
  void add(const TrajectoryPoint& point, const pose_graph::Atlas& atlas);
  /// Forgets what came after `utime`, and what odometry said.
  void roll_back(std::int64_t utime);

  /// In order, one each few centimetres; those of the last 30 s with odometry, where all scans since had it. Of a
  /// vehicle that has stood for longer one more.
  [[nodiscard]] std::vector<TrajectoryPoint> points(const pose_graph::Atlas& atlas) const;
  /// The vehicle is at `T_map_base` now. When its trajectory and odometry last agreed on how it came to be here;
  /// nothing if they agree until the last scan, or never did.
  [[nodiscard]] std::optional<std::int64_t> last_agreement(const Pose& T_map_base, std::int64_t utime,
                                                           const Pose& T_odom_base,
                                                           const pose_graph::Atlas& atlas) const;

 private:
  struct Footprint {
    std::int64_t utime;
    std::int32_t revolution;
    std::int32_t node;
    Eigen::Vector3f position;     // of base_link, seen from the node
    Eigen::Quaternionf attitude;  // likewise
  };
  /// What odometry said at a footprint.
  struct Witness {
    Footprint footprint;
    Pose T_odom_base;
  };
  [[nodiscard]] static Pose T_map_of(const Footprint& footprint, const pose_graph::Atlas& atlas);

  std::vector<Footprint> footprints_;  // one each few centimetres
  std::deque<Witness> witnesses_;      // of the last scans, all with odometry
};

}  // namespace curbstone::mapper
