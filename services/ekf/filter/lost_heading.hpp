#pragma once

#include "services/ekf/model/correction.hpp"
#include "services/ekf/model/error_state.hpp"

namespace curbstone::ekf::filter {

/// A heading that nobody knows any more: the vehicle has coasted where nothing measured how it turned.
///
/// No measurement depends on the heading. But where the tilt is corrected, a large error of the heading only seems to
/// become small; and the covariance, being linear, does not see what it does to the way along it. Here both are kept
/// honest. Until it is lost, nothing is changed. Pure; one thread.
class LostHeading {
 public:
  void lose() { lost_ = true; }
  [[nodiscard]] bool lost() const { return lost_; }

  /// As model::correct(), but for the heading's variance, which stays.
  void correct(model::Belief& belief, const model::Observation& z, const model::Gain& gain) const;
  /// It has driven on by `way` m.
  void drive(model::Belief& belief, double way);

 private:
  bool lost_ = false;
  double astray_ = 0.0;  // m, 1 sigma of the place, by the heading, since it was lost
};

}  // namespace curbstone::ekf::filter
