#pragma once

namespace curbstone {

/// m/s^2, downwards: the standard's. Where a vehicle is it differs by up to 0.03, which an accelerometer's bias takes
/// in.
inline constexpr double kGravity = 9.80665;

}  // namespace curbstone
