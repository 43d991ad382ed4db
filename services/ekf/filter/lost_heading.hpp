#pragma once

#include "services/ekf/model/correction.hpp"
#include "services/ekf/model/error_state.hpp"

namespace curbstone::ekf::filter {

/// Handles a heading that is unknown because the vehicle has coasted where nothing measured its turn.
///
/// No measurement depends on the heading. But a correction of the tilt makes a large heading error seem small, and the
/// covariance, being linear, does not show the effect of that error on the position along the path. This class keeps
/// both consistent. Until the heading is lost nothing is changed. Pure; one thread.
class LostHeading {
 public:
  void lose() { lost_ = true; }
  [[nodiscard]] bool lost() const { return lost_; }

  /// As model::correct(), except that the heading's variance is kept.
  void correct(model::Belief& belief, const model::Observation& z, const model::Gain& gain) const;
  /// The vehicle has driven another `distance` m.
  void propagate(model::Belief& belief, double distance);

 private:
  bool lost_ = false;
  double position_sigma_ = 0.0;  // m, 1 sigma of the position error due to the heading since it was lost
};

}  // namespace curbstone::ekf::filter
