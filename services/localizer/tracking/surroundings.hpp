#pragma once

#include <optional>
#include <vector>

#include "services/localizer/tracking/pose_fit.hpp"

namespace curbstone::localizer::tracking {

/// Looks whether a place within 3 m along and 1.5 m across the vehicle fits clearly better than the pose that is
/// tracked. A street looks alike a metre on: its houses and curbs hold a wrong pose as they hold the right one, and
/// only the comparison tells. The places are 0.7 m apart, which is what a fit reaches. Deterministic; one thread.
class Surroundings {
 public:
  /// The best of the next `count` places about `own`, in turn, if it fits clearly better.
  [[nodiscard]] std::optional<PoseFit> better_than(const PoseFit& own, const std::vector<Eigen::Vector3d>& points,
                                                   int count, fields::SavedMap& map, const TrackingConfig& config);
  /// Whether each place was looked at since restart().
  [[nodiscard]] bool all_seen() const;
  /// Another pose is tracked from now on.
  void restart() { seen_ = 0; }

 private:
  int next_ = 0;
  int seen_ = 0;
};

}  // namespace curbstone::localizer::tracking
