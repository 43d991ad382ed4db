#pragma once

#include <cstdint>
#include <deque>

#include "services/mapper/registration/registration.hpp"
#include "tools/evaluate/truth/trajectory.hpp"

namespace curbstone::bench::mapping {

/// Normalised estimation error squared, NEES (Bar-Shalom, Li, Kirubarajan: Estimation with Applications to Tracking and
/// Navigation, 2001, 5.4), mean over all increments. A consistent covariance gives 6 for all six components and 3 for
/// three of them; higher values mean it is overconfident, lower ones that it is conservative. 0 if there are no
/// increments.
struct Nees {
  double all = 0;
  double translation = 0;  ///< alone, by its own covariance
  double rotation = 0;
  int increments = 0;
};

/// Checks the consistency of a method's claimed pose covariance: the motion of base_link over `span` us against the
/// truth. A filter takes such increments from a map (services/ekf, MapIncrements); as there, the errors of both poses
/// count as independent. Between its stamps the truth is interpolated by a cubic through four poses.
class IncrementConsistency {
 public:
  /// `truth` must outlive this.
  IncrementConsistency(const evaluate::truth::Trajectory& truth, std::int64_t span) : truth_(truth), span_(span) {}

  /// Adds the next pose and its covariance in base_link axes. It is compared only if the truth covers it and there is a
  /// pose about `span` earlier.
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
