#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/geometry/geometry.hpp"

namespace curbstone::evaluate::truth {

struct StampedPose {
  std::int64_t utime = 0;
  Pose pose = Pose::Identity();
};
/// By utime, ascending.
using Trajectory = std::vector<StampedPose>;

/// Pose at a time between two of the trajectory's; nothing outside of it or across a gap of more than `max_gap` us.
[[nodiscard]] std::optional<Pose> pose_at(const Trajectory& trajectory, std::int64_t utime,
                                          std::int64_t max_gap = 500'000);

/// The poses of two trajectories at the same times (those of `estimate`).
struct PosePairs {
  std::vector<Pose> truth;
  std::vector<Pose> estimate;
};
[[nodiscard]] PosePairs pair_up(const Trajectory& truth, const Trajectory& estimate);

/// The rigid transform, without scale, that takes the estimate's positions nearest to the truth's in the least-squares
/// sense (Horn 1987, Umeyama 1991). A path too straight to fix its roll gets it from the poses' own attitudes.
[[nodiscard]] Pose align(const PosePairs& pairs);

struct TrajectoryErrors {
  double distance_m = 0;     ///< driven, by the truth
  double ate_m = 0;          ///< RMS of position after alignment
  double rpe_percent = 0;    ///< mean translation error of sub-paths, in % of their length (KITTI's measure)
  double rpe_deg_per_m = 0;  ///< mean rotation error of them
  double end_percent = 0;    ///< error of the last position when the first poses coincide, in % of the distance
  int segments = 0;          ///< sub-paths measured
};
/// Sub-paths of 10, 20, 30, 40, 50, 60 m begin at every metre; of a shorter drive, half its length.
[[nodiscard]] TrajectoryErrors trajectory_errors(const PosePairs& pairs);

}  // namespace curbstone::evaluate::truth
