#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "services/ekf/wheel_faults/wheel_look.hpp"

namespace curbstone::ekf::wheel_faults {

/// The speed by the wheels and by the IMU within the last two intervals, and whose has leapt. Pure; one thread.
class RecentSpeeds {
 public:
  void add(const WheelLook& look) {
    std::rotate(speeds_.begin(), speeds_.begin() + 1, speeds_.end());
    speeds_.back() = {0.5 * (look.speed[0] + look.speed[1]), look.inertial_speed};
    known_ = std::min(known_ + 1, static_cast<int>(speeds_.size()));
  }
  /// The intervals were interrupted.
  void interrupt() { known_ = 0; }

  struct Leap {
    double wheels = 0.0;  ///< m/s, by which the wheels' speed has changed more than the IMU's
    bool imu = false;     ///< the IMU's has changed, and the wheels' has not
  };
  [[nodiscard]] Leap leap() const {
    const double wheels = std::abs(speeds_.back().wheels - speeds_.front().wheels);
    const double imu = std::abs(speeds_.back().imu - speeds_.front().imu);
    return {wheels - imu, known_ == static_cast<int>(speeds_.size()) && imu > wheels + kLeap};
  }

 private:
  static constexpr double kLeap = 0.5;  // m/s
  struct Speeds {
    double wheels = 0.0, imu = 0.0;  // m/s
  };
  std::array<Speeds, 3> speeds_{};  // newest last
  int known_ = 0;
};

}  // namespace curbstone::ekf::wheel_faults
