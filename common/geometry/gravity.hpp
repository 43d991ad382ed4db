#pragma once

namespace curbstone {

/// Standard gravity, m/s^2, downwards (ISO 80000-3). It differs by up to 0.03 from place to place; the EKF's
/// accelerometer bias absorbs that.
inline constexpr double kGravity = 9.80665;

}  // namespace curbstone
