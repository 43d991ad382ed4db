#pragma once

#include <array>
#include <cstdint>

#include "common/bus/counters.hpp"
#include "services/ekf/inputs/wheel_odometer.hpp"
#include "services/ekf/model/measurement_model.hpp"
#include "services/ekf/model/motion_window.hpp"
#include "services/ekf/wheel_faults/slip_detector.hpp"

namespace curbstone::ekf::wheel_faults {

/// Which wheel slips, from interval to interval of the wheels: the one that the filter finds far off (a sudden slip),
/// or that the SlipDetector shows (one that grows). It is left out for slip.hold after the last sign.
class SlipJudge {
 public:
  SlipJudge(const base::SlipConfig& config, const model::Geometry& geometry)
      : config_(config), geometry_(geometry), detector_(config) {}

  /// `distances`: squared, of both wheels' speeds from the filter's (see distance()); `window`: the filter's motion
  /// over the same interval. `faulty` wheels say nothing (WheelWatch). Counts slips.* and slip_signs.*.
  void judge(const inputs::WheelInterval& interval, const std::array<double, 2>& distances,
             const std::array<bool, 2>& faulty, const model::NavState& state, const model::MotionWindow& window,
             Counters& counters);
  [[nodiscard]] bool slipping(std::size_t wheel, std::int64_t utime) const { return utime < until_[wheel]; }

  /// Densities (rad/s, m/s^2, /sqrt(Hz)) of an IMU that is noisier than usual; else 0.
  void set_noise(double gyro, double accelerometer) { noise_ = {gyro, accelerometer}; }
  /// Whether the gyro does not tell how it turns: then its turn cannot show slip.
  void turn_is_lost(bool lost) {
    turn_is_lost_ = lost;
    detector_.reset();
  }
  /// Neither wheel is believed for slip.hold.
  void accuse(std::int64_t utime);
  /// The intervals were interrupted.
  void reset_detector() { detector_.reset(); }
  /// Both wheels are believed again.
  void acquit() { until_ = {INT64_MIN, INT64_MIN}; }

 private:
  base::SlipConfig config_;
  model::Geometry geometry_;
  SlipDetector detector_;
  std::array<double, 2> noise_ = {};
  bool turn_is_lost_ = false;
  std::array<bool, 2> faulty_ = {};
  std::array<std::int64_t, 2> until_ = {INT64_MIN, INT64_MIN};  // us
};

}  // namespace curbstone::ekf::wheel_faults
