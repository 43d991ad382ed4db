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

/// LiDARs at 1200 rpm: RS-LiDAR-16 (751 packets/s), VLP-16 (754) and a Helios with 32 lasers (1500). Damage is where a
/// driver can see it: the UDP checksum guards distances.
[[nodiscard]] Soak soak_rs16(double hours);
[[nodiscard]] Soak soak_vlp16(double hours);
[[nodiscard]] Soak soak_helios32(double hours);
/// IMUs, 100 samples/s: an Xsens MTi, and a WitMotion, whose samples are of four frames. Corrupt: one byte, which the
/// checksum always shows.
[[nodiscard]] Soak soak_xsens(double hours);
[[nodiscard]] Soak soak_witmotion(double hours);
/// Positions of a wheel drive on CAN, 100/s. Corrupt: their highest byte; the bus has a checksum of its own. Swapped:
/// with a frame of another id that comes within the millisecond, for a bus keeps the order of one id; or late by that.
[[nodiscard]] Soak soak_can(double hours);
/// Positions of a wheel drive on Modbus, 50/s, at the bytes of its line: the polls are the driver's, what libmodbus
/// makes of the bytes is the soak's. Swapped: the reply comes with that to the next request, before it. Only replies
/// with positions are damaged.
[[nodiscard]] Soak soak_modbus(double hours);

}  // namespace curbstone::test
