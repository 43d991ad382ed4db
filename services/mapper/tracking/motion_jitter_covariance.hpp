#pragma once

#include "services/mapper/registration/registration.hpp"
#include "services/mapper/scan/deskew.hpp"

namespace curbstone::mapper::tracking {

/// Estimates the covariance of the pose at a scan's end when no odometry measures the motion during the scan. One
/// thread.
///
/// De-skew then assumes a constant velocity: a point measured at fraction s of the scan is moved back by (1 - s) u from
/// the scan's end, where u is the motion over the scan. To first order registration then determines the pose in the
/// middle of the scan, whatever u is. The end lies half of u further on, and u is computed from the poses themselves.
/// The pose absorbs an error of u, so neither the residuals nor the covariance of the equations contains it. On a
/// recorded street it raised the error of roll and pitch from 0.3 to 1.1 mrad.
///
/// The jitter of the poses does show it. If their errors are independent with covariance P, a second difference
/// e(k) - 2 e(k-1) + e(k-2) has the covariance 6 P (after von Neumann et al., The Mean Square Successive Difference,
/// Ann. Math. Statist. 1941). True changes of the motion add to it, and they displace the end of a scan as well. The
/// estimate is therefore a sixth of the mean square of second differences over the last kMemory scans.
class MotionJitterCovariance {
 public:
  static constexpr int kMemory = 20;

  /// Adds two scans in a row: the motion over the previous one and over this one; `stride`: s from end to end.
  void add(const scan::Twist& before, const scan::Twist& now, double stride);
  /// Covariance in base_link axes. Before the first scans: that of a vehicle that is driven hard.
  [[nodiscard]] registration::Matrix6 covariance() const { return mean_ / 6; }

 private:
  static constexpr double kFirstShift = 0.03;  // m, initial second difference
  static constexpr double kFirstTurn = 0.004;  // rad, likewise

  [[nodiscard]] static registration::Matrix6 first();
  registration::Matrix6 mean_ = first();
  int seen_ = 1;
};

}  // namespace curbstone::mapper::tracking
