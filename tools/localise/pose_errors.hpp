#pragma once

#include <cstdint>
#include <curbstone/map_pose_t.hpp>
#include <optional>
#include <vector>

#include "services/semantic_map/tile/map_types.hpp"
#include "tools/evaluate/truth/trajectory.hpp"

namespace curbstone::localise {

/// The true pose of a vehicle in a saved map. The map is distorted by the drift of the drive that made it. So the true
/// pose is the mean of those implied by the mapping drive's poses within kNear of the place: each places the vehicle
/// consistently with what was mapped from there. Full poses are used, because a map that slid sideways has not turned.
class TrueMapPose {
 public:
  static constexpr double kNear = 12.0;  ///< m
  static constexpr double kEvery = 0.5;  ///< m between those poses, so that standing still has no weight

  /// `map_drive`: trajectory of the map; `map_truth`: truth of the drive that made it; `truth`: truth of the drive to
  /// score. All in one world.
  TrueMapPose(const std::vector<semantic_map::tile::TrajectoryPose>& map_drive, evaluate::truth::Trajectory map_truth,
              evaluate::truth::Trajectory truth);
  /// T_map_base; empty outside the drive's truth.
  [[nodiscard]] std::optional<Pose> at(std::int64_t utime) const;

 private:
  evaluate::truth::PosePairs drive_;  // truth: in the map; estimate: in the world
  evaluate::truth::Trajectory truth_;
};

/// Errors of the poses that are not LOST.
struct PoseErrors {
  int poses = 0;                       ///< all
  int lost = 0;                        ///< of these, LOST
  int judged = 0;                      ///< of the others, those with a truth
  double lateral_rmse = 0;             ///< m, across base_link
  double lateral_99 = 0;               ///< m
  double lateral_degenerate_rmse = 0;  ///< m, of the revolutions that do not constrain the longitudinal position
  double lateral_degenerate_99 = 0;    ///< m
  double longitudinal_rmse = 0;        ///< m, along base_link, over the poses not marked as degenerate
  double longitudinal_99 = 0;          ///< m
  double longitudinal_all = 0;         ///< m, RMSE along base_link over all judged poses
  int degenerate = 0;                  ///< poses marked as unconstrained in the direction of travel
  double yaw_rmse = 0;                 ///< deg
  double nees = 0;                     ///< mean over x, y, yaw: 3 for a consistent covariance
  double nees_lateral = 0;             ///< mean of one component: 1 for a consistent sigma; less if it is too large
  double nees_longitudinal = 0;
  double nees_yaw = 0;
  double beyond_95 = 0;    ///< share with a NEES over 7.815
  double worst = 0;        ///< m, in the plane
  int wrong_and_sure = 0;  ///< not LOST, but off by 0.5 m or more
};
[[nodiscard]] PoseErrors errors_of(const std::vector<map_pose_t>& poses, const TrueMapPose& truth);

}  // namespace curbstone::localise
