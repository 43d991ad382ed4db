#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "services/ekf/base/samples.hpp"

namespace curbstone::ekf::wheel_faults {

/// An interval of the wheels while the vehicle drives, with the filter's expectation. Arrays are left, right.
struct WheelObservation {
  std::int64_t begin = 0;               ///< us
  std::int64_t end = 0;                 ///< us
  std::array<double, 2> speed = {};     ///< m/s, of the wheels
  std::array<double, 2> expected = {};  ///< m/s, the filter's expectation of the wheels
  std::array<double, 2> sigma = {};     ///< m/s, 1 sigma of the difference
  std::array<bool, 2> refused = {};     ///< the wheel counts as slipping
  double yaw_rate = 0.0;                ///< rad/s, by the gyro
  double inertial_speed = 0.0;          ///< m/s, integrated forward acceleration from an arbitrary zero

  [[nodiscard]] double seconds() const { return base::seconds_between(begin, end); }
  /// m/s, wheel minus filter.
  [[nodiscard]] double difference(std::size_t wheel) const { return speed[wheel] - expected[wheel]; }
};

}  // namespace curbstone::ekf::wheel_faults
