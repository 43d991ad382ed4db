#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "services/ekf/wheel_faults/wheel_observation.hpp"

namespace curbstone::ekf::wheel_faults {

/// The speeds of wheels and IMU over the last two intervals, and which of them has leapt. Pure; one thread.
class RecentSpeeds {
 public:
  void add(const WheelObservation& observation) {
    std::rotate(speeds_.begin(), speeds_.begin() + 1, speeds_.end());
    speeds_.back() = {observation.end, 0.5 * (observation.speed[0] + observation.speed[1]), observation.inertial_speed};
    known_ = std::min(known_ + 1, static_cast<int>(speeds_.size()));
  }
  /// Call it where intervals are missing.
  void interrupt() { known_ = 0; }

  struct Leap {
    double wheels = 0.0;  ///< m/s, change of the wheels' speed minus that of the IMU's, magnitudes
    bool imu = false;     ///< the IMU's speed has leapt, and the wheels' has not
    double offset = 0.0;  ///< m/s, by which the wheels' speed differs since, if that is due to a change of the IMU's
  };
  [[nodiscard]] Leap leap() const {
    const double of_wheels = speeds_.back().wheels - speeds_.front().wheels;
    const double of_imu = speeds_.back().imu - speeds_.front().imu;
    const double more = known_ == static_cast<int>(speeds_.size()) ? std::abs(of_imu) - std::abs(of_wheels) : 0.0;
    const double step = kStep * base::seconds_between(speeds_.front().end, speeds_.back().end);
    return {std::abs(of_wheels) - std::abs(of_imu), more > kLeap, more > step ? of_wheels - of_imu : 0.0};
  }

 private:
  static constexpr double kLeap = 0.5;  // m/s
  static constexpr double kStep = 1.0;  // m/s^2: when a vehicle drives off, wheels that do not turn lag by less
  struct Speeds {
    std::int64_t end = 0;            // us
    double wheels = 0.0, imu = 0.0;  // m/s
  };
  std::array<Speeds, 3> speeds_{};  // newest last
  int known_ = 0;
};

}  // namespace curbstone::ekf::wheel_faults
