#pragma once

#include "services/mapper/scan/deskew.hpp"

namespace curbstone::mapper::tracking {

/// How the vehicle moves where scans alone tell. One thread.
///
/// A scan is de-skewed with a twist that is assumed, and to first order its registration then fixes where the
/// vehicle was when its points were taken, in the mean, `age` before its end, whatever was assumed; the pose at the end
/// lies `age` of the true twist further on. Who takes the answer for the end, the difference of two ends for the
/// twist, and de-skews with that until both agree, has built an oscillator: an error e of one end makes the next -e.
/// So a part of what does not fit is taken for a change of the twist, the rest for an error of the last end: with
/// points all through the scan e then becomes (1 - 2 kShare) e, and where the twist changes by c each scan
/// the end is (1 - kShare) / (4 kShare) c behind. The map, which the next is registered to, passes on a part of each
/// error too: in drives, 0.8 was unstable, and 0.5 to 0.65 good.
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
