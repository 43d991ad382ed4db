#pragma once

#include "services/mapper/registration/registration.hpp"
#include "services/mapper/scan/deskew.hpp"

namespace curbstone::mapper::tracking {

/// What the pose at a scan's end is off by when no odometry tells of the motion during it. One thread.
///
/// De-skew then takes the motion for steady: a point taken at share s of the scan is put (1 - s) u back from its
/// end, u being the motion over it. To first order registration so fixes the pose in the middle, whatever u; the end
/// lies half of u further on, and u comes from the poses themselves. The residuals say nothing of an error of u, as the
/// pose takes it up; the covariance of the equations does not know it either. On a recorded street it made of 0.3 mrad
/// of roll and pitch 1.1.
///
/// What does show it is how unsteady the poses are. Let their errors be independent with covariance P: a second
/// difference e(k) - 2 e(k-1) + e(k-2) then has 6 P (after von Neumann et al., The Mean Square Successive Difference,
/// Ann. Math. Statist. 1941). True changes of the motion add to it, and displace the end of a scan as well. So
/// a sixth of the mean square of second differences is claimed, of the last kMemory scans.
class MotionJitterCovariance {
 public:
  static constexpr int kMemory = 20;

  /// Two scans in a row: the motion over the one before, over this one, and how long this one lasted, s.
  void add(const scan::Twist& before, const scan::Twist& now, double stride);
  /// In base_link axes. Before it has seen any: as of a vehicle that is driven hard.
  [[nodiscard]] registration::Matrix6 covariance() const { return mean_ / 6; }

 private:
  static constexpr double kFirstShift = 0.03;  // m, second difference
  static constexpr double kFirstTurn = 0.004;  // rad, likewise

  [[nodiscard]] static registration::Matrix6 first();
  registration::Matrix6 mean_ = first();
  int seen_ = 1;
};

}  // namespace curbstone::mapper::tracking
