#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "common/geometry/geometry.hpp"
#include "services/mapper/pose_graph/atlas.hpp"

namespace curbstone::mapper {

/// The pose in map at the end of a scan.
struct TrajectoryPoint {
  std::int64_t utime;  ///< us
  std::int32_t revolution;
  Pose T_map_base;
  std::int32_t node = 0;                           ///< of the atlas: the keyframe that the vehicle was at
  std::optional<Pose> T_odom_base = std::nullopt;  ///< by odometry, if known
};

/// The drive's poses, each stored relative to a keyframe, so that they move with the keyframes when a loop is closed.
/// Of the latest poses it also keeps the pose by odometry, so that map and odometry can be compared. Pure; one thread.
class Trajectory {
 public:
  /// Adds the pose of a scan that was tracked.
  void add(const TrajectoryPoint& point, const pose_graph::Atlas& atlas);
  /// Drops all poses after `utime`, us, from which odometry leads to where the vehicle is.
  void roll_back(std::int64_t utime);

  /// Poses in order of time, one every few centimetres. Those of the last 30 s include odometry's pose, if all scans
  /// since had one. If the vehicle has stood for longer than that, one more pose with odometry is appended.
  [[nodiscard]] std::vector<TrajectoryPoint> points(const pose_graph::Atlas& atlas) const;
  /// The vehicle is at `T_map_base` at `utime`. Returns the time, us, of the latest pose from which odometry leads to
  /// `T_map_base`; nothing if that is the last pose, or if there is none within 30 s. Nothing, too, once the host's
  /// clock was set back during the drive: then stamps no longer order the map, and it cannot be rolled back to a time.
  [[nodiscard]] std::optional<std::int64_t> last_agreement(const Pose& T_map_base, std::int64_t utime,
                                                           const Pose& T_odom_base,
                                                           const pose_graph::Atlas& atlas) const;

 private:
  struct StoredPose {
    std::int64_t utime;
    std::int32_t revolution;
    std::int32_t node;
    Eigen::Vector3f position;     // of base_link in the node's frame, m
    Eigen::Quaternionf attitude;  // base_link to the node's frame
  };
  /// A stored pose and the one by odometry at the same time.
  struct OdometryPair {
    StoredPose pose;
    Pose T_odom_base;
  };
  [[nodiscard]] static Pose T_map_of(const StoredPose& pose, const pose_graph::Atlas& atlas);

  std::vector<StoredPose> stored_poses_;     // one every few centimetres
  std::deque<OdometryPair> odometry_pairs_;  // of the last scans, all with odometry
  std::int64_t last_utime_ = 0;              // us, of the last pose added
  bool was_set_back_ = false;                // the clock
};

}  // namespace curbstone::mapper
