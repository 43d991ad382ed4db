#pragma once

#include "services/mapper/scan/deskew.hpp"

namespace curbstone::mapper::tracking {

/// Estimates the vehicle's motion from scans alone, without odometry (docs/method.md, section 4). One thread.
///
/// A scan is de-skewed with an assumed twist. To first order its registration determines the pose at the mean time of
/// its points, `age` before its end, whatever twist was assumed; the pose at the end is that pose, moved on by the true
/// twist for `age`. An estimator that takes the registration's result as the pose at the end, and the difference of two
/// ends as the twist, oscillates: an error e of one end makes the next one -e.
///
/// So kShare of the difference counts as a change of the twist, the rest as an error of the last end. With points all
/// through the scan an error e then becomes (1 - 2 kShare) e, and if the twist changes by c each scan, the end lags by
/// (1 - kShare) / (4 kShare) c. The map that the next scan is registered to passes on part of each error too: in
/// drives, a share of 0.8 was unstable, and 0.5 to 0.65 worked well.
class MotionFilter {
 public:
  static constexpr double kShare = 0.6;

  /// Result of the registration of a scan that was de-skewed with `assumed`.
  struct Found {
    Pose T_last_base = Pose::Identity();  ///< base_link at this scan's end to base_link at the last's
    scan::Twist assumed;
    double age = 0;     ///< s from the mean time of its points to its end
    double stride = 0;  ///< s since the end of the last scan, above 0
  };

  /// Sets the twist from a better source, in base_link.
  void set(const scan::Twist& twist) { twist_ = twist; }
  /// The twist at the end of the last scan, in base_link.
  [[nodiscard]] const scan::Twist& twist() const { return twist_; }

  /// Takes the next scan. Returns the corrected T_last_base at its end.
  Pose take(const Found& found);

 private:
  scan::Twist twist_;
};

}  // namespace curbstone::mapper::tracking
