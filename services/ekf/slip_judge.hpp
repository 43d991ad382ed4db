#pragma once

#include <array>
#include <cstdint>

#include "common/counters.hpp"
#include "services/ekf/measurement_model.hpp"
#include "services/ekf/motion_window.hpp"
#include "services/ekf/slip_detector.hpp"
#include "services/ekf/wheel_odometer.hpp"

namespace curbstone {

/// Which wheel slips, from interval to interval of the wheels: the one that the filter finds far off (a sudden slip),
/// or that the SlipDetector shows (one that grows). It is left out for slip.hold after the last sign.
class SlipJudge {
 public:
  SlipJudge(const SlipConfig& config, const Geometry& geometry)
      : config_(config), geometry_(geometry), detector_(config) {}

  /// `distances`: squared, of both wheels' speeds from the filter's (see distance()); `window`: the filter's motion
  /// over the same interval. Counts slips.* and slip_signs.*.
  void judge(const WheelInterval& interval, const std::array<double, 2>& distances, const NavState& state,
             const MotionWindow& window, Counters& counters);
  [[nodiscard]] bool slipping(std::size_t wheel, std::int64_t utime) const { return utime < until_[wheel]; }

  /// The intervals were interrupted.
  void reset_detector() { detector_.reset(); }
  /// Both wheels are believed again.
  void acquit() { until_ = {INT64_MIN, INT64_MIN}; }

 private:
  SlipConfig config_;
  Geometry geometry_;
  SlipDetector detector_;
  std::array<std::int64_t, 2> until_ = {INT64_MIN, INT64_MIN};  // us
};

}  // namespace curbstone
