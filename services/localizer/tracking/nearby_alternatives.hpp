#pragma once

#include <optional>
#include <vector>

#include "services/localizer/tracking/pose_fit.hpp"

namespace curbstone::localizer::tracking {

/// Checks whether a place within 3 m along and 1.5 m across the vehicle fits clearly better than the tracked pose. A
/// street looks similar a metre further on: its houses and curbs hold a wrong pose as well as the right one, and only
/// the comparison tells them apart. The places are 0.7 m apart, which is the convergence range of a fit. Deterministic;
/// one thread.
class NearbyAlternatives {
 public:
  /// Fits the next `count` places around `own`, in turn. Returns the best one if it fits clearly better than `own`.
  [[nodiscard]] std::optional<PoseFit> better_than(const PoseFit& own, const ThinnedScan& scan, int count,
                                                   fields::SavedMap& map, const TrackingConfig& config);
  /// Whether every place was tried since restart().
  [[nodiscard]] bool all_tried() const;
  /// Call it when another pose is tracked.
  void restart() { seen_ = 0; }

 private:
  int next_ = 0;
  int seen_ = 0;
};

}  // namespace curbstone::localizer::tracking
