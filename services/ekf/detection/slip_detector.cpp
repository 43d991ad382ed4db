#include "services/ekf/detection/slip_detector.hpp"

#include <cmath>

namespace curbstone::ekf::detection {

SlipDetector::Signs SlipDetector::add(const Comparison& c) {
  Signs signs;
  signs.turning =
      std::abs(c.wheel_yaw_rate - c.gyro_yaw_rate) > config_.yaw_rate + config_.yaw_share * std::abs(c.gyro_yaw_rate);

  differences_.push_back({c.end, c.wheel_speed - c.inertial_speed});
  while (differences_.size() > 2 && c.end - differences_[1].time >= config_.window) differences_.pop_front();
  for (const Difference& past : differences_) {
    if (std::abs(differences_.back().speed - past.speed) > config_.speed_change) signs.speeding = true;
  }
  return signs;
}

}  // namespace curbstone::ekf::detection
