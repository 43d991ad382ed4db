#pragma once

namespace curbstone::lidar::packet {

/// Why a packet is not used. Each has a counter of its own, "refused.<name>".
enum class Refusal {
  kNone,
  kLength,      ///< not 1248 bytes
  kMagic,       ///< does not begin as an RS16 packet does
  kHelios16p,   ///< a point packet of the successor: same ports, same length, another layout
  kBlock,       ///< a data block without its flag
  kAzimuth,     ///< beyond 359.99 deg
  kDualReturn,  ///< the device is set to report two returns a shot
  kLate,        ///< fired before one that came earlier
  kDuplicate,
  kDifopMode,    ///< device information with a return mode that no RS16 has: an RS-Helios-16P sends the same magic
  kDifopAngles,  ///< device information with elevations that no RS16 has
};

/// The counter's name.
[[nodiscard]] constexpr const char* counter_of(Refusal refusal) {
  switch (refusal) {
    case Refusal::kNone:
      return "";
    case Refusal::kLength:
      return "refused.length";
    case Refusal::kMagic:
      return "refused.magic";
    case Refusal::kHelios16p:
      return "refused.helios_16p";
    case Refusal::kBlock:
      return "refused.block";
    case Refusal::kAzimuth:
      return "refused.azimuth";
    case Refusal::kDualReturn:
      return "refused.dual_return";
    case Refusal::kLate:
      return "refused.late";
    case Refusal::kDuplicate:
      return "refused.duplicate";
    case Refusal::kDifopMode:
      return "refused.difop_mode";
    case Refusal::kDifopAngles:
      return "refused.difop_angles";
  }
  return "refused.unknown";
}

}  // namespace curbstone::lidar::packet
