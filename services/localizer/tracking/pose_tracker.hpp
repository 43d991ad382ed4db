#pragma once

#include <vector>

#include "services/localizer/tracking/prediction.hpp"

namespace curbstone::localizer::tracking {

/// Follows one pose through the saved map, revolution by revolution. One thread; deterministic.
class PoseTracker {
 public:
  virtual ~PoseTracker() = default;

  /// Processes one revolution. `scan`: in base_link at its end.
  virtual PoseFit track(const ThinnedScan& scan, const Motion& motion, fields::SavedMap& map) = 0;
  [[nodiscard]] virtual const PoseBelief& belief() const = 0;
  /// The covariance of the pose including the error of the map itself.
  [[nodiscard]] virtual Matrix6 published_covariance() const = 0;
  [[nodiscard]] virtual bool lost() const = 0;
};

}  // namespace curbstone::localizer::tracking
