#pragma once

#include "tests/drivers/soak/ledger.hpp"

namespace curbstone::test {

/// What a soak of one driver ended with.
struct Soak {
  Ledger ledger;
  NodeReport report;
};

// Each feeds a driver's node, on a bus inside the process and on a clock of its own, as fast as it takes it, what an
// emulated device sends over a way that damages 4 % (Damage). The first and last two seconds are spared.

/// RS-LiDAR-16, 750 packets/s. Damage is where a driver can see it: the UDP checksum guards distances.
[[nodiscard]] Soak soak_lidar(double hours);
/// Xsens MTi, 100 samples/s. Corrupt: one byte, which the checksum always shows.
[[nodiscard]] Soak soak_imu(double hours);
/// Positions of a wheel drive on CAN, 100/s. Corrupt: their highest byte; the bus has a checksum of its own. Swapped:
/// with a frame of another id that comes within the millisecond, for a bus keeps the order of one id; or late by that.
[[nodiscard]] Soak soak_encoder(double hours);

}  // namespace curbstone::test
