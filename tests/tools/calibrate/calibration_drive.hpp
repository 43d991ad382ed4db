#pragma once

#include "common/config/vehicle.hpp"
#include "tools/calibrate/calibration.hpp"
#include "tools/simulate/motion/motion.hpp"

namespace curbstone::calibrate {

/// The vehicle as it is in these tests: nothing is at its default place.
[[nodiscard]] VehicleConfig true_vehicle();
/// What its file says: radius 2 %, track 5 %, the LiDAR 8 cm and 2 degrees, the IMU 5 cm and 1 degree off.
[[nodiscard]] VehicleConfig believed_vehicle();

/// Round the block of the simulated town (bends to the left only, in which it leans), bends to both sides in which it
/// leans as well, and straight on; the last two on even ground, nodding a little.
[[nodiscard]] const simulate::motion::Motion& town_motion();
[[nodiscard]] const simulate::motion::Motion& winding_motion();
[[nodiscard]] const simulate::motion::Motion& straight_motion();

/// What LiDAR odometry (3 mm, 0.3 mrad), wheels with the simulator's slips, and its IMU say of a motion.
[[nodiscard]] CalibrationData drive_to_calibrate(const simulate::motion::Motion& motion, double seconds,
                                                 std::uint64_t seed);

}  // namespace curbstone::calibrate
