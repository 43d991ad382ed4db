#pragma once

#include <array>
#include <cstdint>

#include "common/bus/counters.hpp"
#include "services/ekf/inputs/wheel_odometer.hpp"
#include "services/ekf/model/measurement_model.hpp"
#include "services/ekf/model/motion_window.hpp"
#include "services/ekf/wheel_faults/slip_detector.hpp"

namespace curbstone::ekf::wheel_faults {

/// Decides for each interval which wheel slips: the one that is far from the filter's expectation (sudden slip), or
/// that the SlipDetector finds (growing slip). It is left out for slip.hold after the last sign.
class SlipJudge {
 public:
  SlipJudge(const base::SlipConfig& config, const model::Geometry& geometry)
      : config_(config), geometry_(geometry), detector_(config) {}

  /// `distances`: squared Mahalanobis distances of both wheels' speeds (see squared_mahalanobis()); `window`: the
  /// filter's motion over the same interval. `faulty` wheels are ignored (WheelWatch). Counts slips.* and slip_signs.*.
  void judge(const inputs::WheelInterval& interval, const std::array<double, 2>& distances,
             const std::array<bool, 2>& faulty, const model::NavState& state, const model::MotionWindow& window,
             Counters& counters);
  [[nodiscard]] bool slipping(std::size_t wheel, std::int64_t utime) const { return utime < until_[wheel]; }

  /// Noise densities (rad/s, m/s^2, each /sqrt(Hz)) of an IMU that is noisier than usual; else 0.
  void set_noise(double gyro, double accelerometer) { noise_ = {gyro, accelerometer}; }
  /// Whether the gyro does not measure the vehicle's turn. If so, the yaw rates are not compared.
  void set_yaw_rate_unmeasured(bool unmeasured) {
    yaw_rate_unmeasured_ = unmeasured;
    detector_.reset();
  }
  /// Refuses both wheels for slip.hold.
  void reject_both(std::int64_t utime);
  /// Call it where intervals are missing.
  void reset_detector() { detector_.reset(); }
  /// Accepts both wheels again.
  void accept_both() { until_ = {INT64_MIN, INT64_MIN}; }

 private:
  base::SlipConfig config_;
  model::Geometry geometry_;
  SlipDetector detector_;
  std::array<double, 2> noise_ = {};
  bool yaw_rate_unmeasured_ = false;
  std::array<bool, 2> faulty_ = {};
  std::array<std::int64_t, 2> until_ = {INT64_MIN, INT64_MIN};  // us
};

}  // namespace curbstone::ekf::wheel_faults
