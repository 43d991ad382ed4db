#include "services/ekf/wheel_faults/slip_detector.hpp"

#include <algorithm>
#include <cmath>

namespace curbstone::ekf::wheel_faults {

namespace {
constexpr double kSure = 4.0;  // sigma
}

SlipDetector::Signs SlipDetector::add(const Comparison& c) {
  Signs signs;
  const double share = config_.yaw_share + kSure * c.jitter;
  signs.turning = std::abs(c.wheel_yaw_rate - c.gyro_yaw_rate) >
                  config_.yaw_rate + share * std::abs(c.gyro_yaw_rate) + kSure * c.gyro_noise;

  differences_.push_back({c.end, c.wheel_speed - c.inertial_speed, std::abs(c.wheel_speed) * c.jitter});
  while (differences_.size() > 2 && c.end - differences_[1].time >= config_.window) differences_.pop_front();
  const Difference& now = differences_.back();
  for (const Difference& past : differences_) {
    const double by_noise = c.speed_noise * std::sqrt(std::max(0.0, now.time - past.time));
    const double sigma = std::hypot(now.sigma, past.sigma, by_noise);
    if (std::abs(now.speed - past.speed) > config_.speed_change + kSure * sigma) signs.speeding = true;
  }
  return signs;
}

}  // namespace curbstone::ekf::wheel_faults
