#pragma once

#include <cstdint>
#include <deque>

#include "services/mapper/registration/registration.hpp"
#include "tools/evaluate/truth/trajectory.hpp"

namespace curbstone::bench::mapping {

/// Normalised estimation error squared, NEES (Bar-Shalom, Li, Kirubarajan: Estimation with Applications to Tracking and
/// Navigation, 2001, 5.4), means over all increments: 6 of the six together, 3 of three, where a method claims what is
/// true; more where the covariance is overconfident, less where it is careful. 0 where there are none.
struct Nees {
  double all = 0;
  double translation = 0;  ///< alone, by the covariance claimed for it
  double rotation = 0;
  int increments = 0;
};

/// Whether what a method claims for its poses is honest: how base_link moved over `span` us, against the truth. It is
/// what a filter takes from a map (services/ekf, MapIncrements), with the errors of both poses held for independent, as
/// there. Between its stamps the truth lies on a cubic through four poses.
class IncrementConsistency {
 public:
  /// `truth` outlives it.
  IncrementConsistency(const evaluate::truth::Trajectory& truth, std::int64_t span) : truth_(truth), span_(span) {}

  /// The next pose, and its covariance in base_link axes. Without a truth about it, or a pose about `span` before it,
  /// there is nothing to compare.
  void add(const evaluate::truth::StampedPose& pose, const mapper::registration::Matrix6& covariance);
  [[nodiscard]] Nees mean() const;

 private:
  struct Claim {
    evaluate::truth::StampedPose stamped;
    mapper::registration::Matrix6 covariance;
  };
  void compare(const Claim& begin, const Claim& end);

  const evaluate::truth::Trajectory& truth_;
  std::int64_t span_;
  std::deque<Claim> recent_;
  Nees sum_;
};

}  // namespace curbstone::bench::mapping
