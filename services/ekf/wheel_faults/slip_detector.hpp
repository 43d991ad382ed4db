#pragma once

#include <deque>

#include "services/ekf/base/ekf_config.hpp"

namespace curbstone::ekf::wheel_faults {

/// Detects wheels that disagree with the IMU. The filter's gate detects a sudden slip; this class detects slip that
/// grows slowly enough to pull the filter along. Over some tenths of a second an IMU measures turns and changes of
/// speed well, whatever the filter's state.
class SlipDetector {
 public:
  explicit SlipDetector(const base::SlipConfig& config) : config_(config) {}

  /// Measurements of both over one interval of the wheels.
  struct Comparison {
    double end = 0.0;             ///< s, end of the interval, on any clock
    double wheel_speed = 0.0;     ///< m/s, mean of both wheels, calibrated
    double wheel_yaw_rate = 0.0;  ///< rad/s, calibrated
    double gyro_yaw_rate = 0.0;   ///< rad/s, minus bias
    double inertial_speed = 0.0;  ///< m/s, integrated forward acceleration from any zero, mean over the interval
    double jitter = 0.0;          ///< 1 sigma of the wheels' error due to the stamps, as a share of their speed
    double gyro_noise = 0.0;      ///< rad/s, 1 sigma of gyro_yaw_rate, where the IMU is noisier than usual
    double speed_noise = 0.0;     ///< m/s/sqrt(s), random walk of inertial_speed, likewise
  };
  struct Signs {
    bool turning = false;   ///< the yaw rates differ: one wheel slips
    bool speeding = false;  ///< the changes of speed differ: both slip
  };
  Signs add(const Comparison& c);
  void reset() { differences_.clear(); }

 private:
  struct Difference {
    double time;   // s
    double speed;  // m/s, wheel minus inertial
    double sigma;  // m/s, due to the stamps' jitter
  };
  base::SlipConfig config_;
  std::deque<Difference> differences_;
};

}  // namespace curbstone::ekf::wheel_faults
