#pragma once

#include <deque>

#include "services/ekf/base/ekf_config.hpp"

namespace curbstone::ekf::wheel_faults {

/// Wheels that say something else than the IMU. A sudden slip is seen by the filter's gate already; this finds slip
/// that grows slowly enough to pull the filter along: over some tenths of a second an IMU knows turns and changes of
/// speed well, whatever the filter believes.
class SlipDetector {
 public:
  explicit SlipDetector(const base::SlipConfig& config) : config_(config) {}

  /// What both saw over one interval of the wheels.
  struct Comparison {
    double end = 0.0;             ///< s, of the interval, on any clock
    double wheel_speed = 0.0;     ///< m/s, mean of both wheels, calibrated
    double wheel_yaw_rate = 0.0;  ///< rad/s, calibrated
    double gyro_yaw_rate = 0.0;   ///< rad/s, less bias
    double inertial_speed = 0.0;  ///< m/s, integral of forward acceleration since any start, mean over the interval
    double jitter = 0.0;          ///< share of what the wheels show, 1 sigma, by which the stamps may have put it off
    double gyro_noise = 0.0;      ///< rad/s, 1 sigma of gyro_yaw_rate, where the IMU is noisier than usual
    double speed_noise = 0.0;     ///< m/s/sqrt(s), by which inertial_speed walks at random, likewise
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
    double speed;  // m/s, wheel less inertial
    double sigma;  // m/s, by the stamps' jitter
  };
  base::SlipConfig config_;
  std::deque<Difference> differences_;
};

}  // namespace curbstone::ekf::wheel_faults
