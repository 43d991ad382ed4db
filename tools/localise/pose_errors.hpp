#pragma once

#include <cstdint>
#include <curbstone/map_pose_t.hpp>
#include <optional>
#include <vector>

#include "services/semantic_map/tile/map_types.hpp"
#include "tools/evaluate/truth/trajectory.hpp"

namespace curbstone::localise {

/// Where a vehicle truly is in a saved map. The map is bent by the drift of the drive that made it. So the truth is
/// what the poses of that drive within kNear of the place say of it, in the mean: each has it where what was mapped
/// from there has it. Whole poses count, as a map that slid sideways has not turned.
class TrueMapPose {
 public:
  static constexpr double kNear = 12.0;  ///< m
  static constexpr double kEvery = 0.5;  ///< m between those poses: where it stood counts no more

  /// `map_drive`: of the map; `map_truth`: of the drive that made it; `truth`: of the drive to be judged. One world.
  TrueMapPose(const std::vector<semantic_map::tile::TrajectoryPose>& map_drive, evaluate::truth::Trajectory map_truth,
              evaluate::truth::Trajectory truth);
  /// T_map_base; nothing where the drive's truth does not reach.
  [[nodiscard]] std::optional<Pose> at(std::int64_t utime) const;

 private:
  evaluate::truth::PosePairs drive_;  // truth: in the map; estimate: in the world
  evaluate::truth::Trajectory truth_;
};

/// Errors of the poses that do not say LOST.
struct PoseErrors {
  int poses = 0;                       ///< all
  int lost = 0;                        ///< of them, that say so
  int judged = 0;                      ///< of the others, those with a truth
  double lateral_rmse = 0;             ///< m, across base_link
  double lateral_99 = 0;               ///< m
  double lateral_degenerate_rmse = 0;  ///< m, of the revolutions that do not constrain the longitudinal pose
  double lateral_degenerate_99 = 0;    ///< m
  double longitudinal_rmse = 0;        ///< m, along base_link, where that is not said to be degenerate
  double longitudinal_99 = 0;          ///< m
  double longitudinal_all = 0;         ///< m, RMSE along base_link of all that are judged
  int degenerate = 0;                  ///< poses that say that the direction of travel is not constrained
  double yaw_rmse = 0;                 ///< deg
  double nees = 0;                     ///< mean of x, y, yaw: 3 when the covariance is right
  double nees_lateral = 0;             ///< mean of each by itself: 1 when its sigma is right; below, it is too wide
  double nees_longitudinal = 0;
  double nees_yaw = 0;
  double beyond_95 = 0;    ///< share with a NEES over 7.815
  double worst = 0;        ///< m, in the plane
  int wrong_and_sure = 0;  ///< off by 0.5 m or more
};
[[nodiscard]] PoseErrors errors_of(const std::vector<map_pose_t>& poses, const TrueMapPose& truth);

}  // namespace curbstone::localise
