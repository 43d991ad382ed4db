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
/// In ascending order of utime.
using Trajectory = std::vector<StampedPose>;

/// The pose interpolated between two of the trajectory's; empty outside it or across a gap of more than `max_gap` us.
[[nodiscard]] std::optional<Pose> pose_at(const Trajectory& trajectory, std::int64_t utime,
                                          std::int64_t max_gap = 500'000);

/// The poses of two trajectories at the same times (those of `estimate`).
struct PosePairs {
  std::vector<Pose> truth;
  std::vector<Pose> estimate;
};
[[nodiscard]] PosePairs pair_up(const Trajectory& truth, const Trajectory& estimate);

/// The rigid transform, without scale, that aligns the estimate's positions to the truth's in the least-squares sense
/// (Horn 1987, Umeyama 1991). If a path is too straight to fix its roll, the attitudes of the poses fix it.
[[nodiscard]] Pose align(const PosePairs& pairs);

struct TrajectoryErrors {
  double distance_m = 0;     ///< driven, by the truth
  double ate_m = 0;          ///< RMS of position after alignment
  double rpe_percent = 0;    ///< mean translation error of sub-paths, in % of their length (KITTI metric)
  double rpe_deg_per_m = 0;  ///< mean rotation error of the sub-paths
  double end_percent = 0;    ///< error of the last position with the first poses aligned, in % of the distance
  int segments = 0;          ///< number of sub-paths
};
/// Sub-paths of 10, 20, 30, 40, 50, 60 m begin at every metre; for a shorter drive, sub-paths of half its length.
[[nodiscard]] TrajectoryErrors trajectory_errors(const PosePairs& pairs);

}  // namespace curbstone::evaluate::truth
