#pragma once

#include "services/mapper/scan/deskew.hpp"

namespace curbstone::mapper::tracking {

/// The vehicle's motion from scans alone, without odometry (docs/method.md, section 4). One thread.
///
/// A scan is de-skewed with a twist that is assumed. To first order its registration then fixes where the vehicle was
/// at the mean time of its points, `age` before its end, whatever was assumed; the pose at the end is that pose, moved
/// on by the true twist for `age`. To take registration's result for the pose at the end, and the difference of two
/// ends for the twist, would oscillate: an error e of one end makes the next one -e. So a share of the difference is
/// taken for a change of the twist, the rest for an error of the last end. With points all through the scan e then
/// becomes (1 - 2 kShare) e, and where the twist changes by c each scan the end is (1 - kShare) / (4 kShare) c behind.
/// The map, to which the next scan is registered, passes on a part of each error too: in drives, 0.8 was unstable, and
/// 0.5 to 0.65 good.
class MotionFilter {
 public:
  static constexpr double kShare = 0.6;

  /// A scan that was de-skewed with `assumed`, and where registration then found its end.
  struct Found {
    Pose T_last_base = Pose::Identity();  ///< base_link there, seen from the end of the last scan
    scan::Twist assumed;
    double age = 0;     ///< s from when its points were taken, in the mean, to its end
    double stride = 0;  ///< s since the end of the last scan, above 0
  };

  /// Something better tells how the vehicle moves.
  void set(const scan::Twist& twist) { twist_ = twist; }
  /// How it moves at the end of the last scan, in base_link.
  [[nodiscard]] const scan::Twist& twist() const { return twist_; }

  /// The next scan. Returns T_last_base at its end.
  Pose take(const Found& found);

 private:
  scan::Twist twist_;
};

}  // namespace curbstone::mapper::tracking
