#pragma once

namespace curbstone::lidar::decoding {

/// Why a packet of the device is not used. Each cause has its own counter, "refused.<name>". A packet of another device
/// is counted under that device's name: see models/base/sender.hpp.
enum class Refusal {
  kNone,
  kLength,    ///< not a length of this device's packets
  kMagic,     ///< the beginning or a mark is not that of this device's packets
  kBlock,     ///< a data block without its flag
  kAzimuth,   ///< beyond 359.99 deg, or impossible for the head at that time
  kStamp,     ///< a time that fits neither the previous packets nor the time of receipt
  kMode,      ///< a return mode that the device does not have
  kNoAngles,  ///< the lasers' elevations are not known yet
  kLate,      ///< fired before one that was already released
  kDuplicate,
  kOtherDevice,  ///< it continues others of which each came between good ones: a second device, with the same address
  kDifopMode,    ///< device information with a return mode that the device does not have
  kDifopAngles,  ///< device information with angles that the device cannot have
  kPosition,     ///< a position packet without its expected contents
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
    case Refusal::kBlock:
      return "refused.block";
    case Refusal::kAzimuth:
      return "refused.azimuth";
    case Refusal::kStamp:
      return "refused.stamp";
    case Refusal::kMode:
      return "refused.return_mode";
    case Refusal::kNoAngles:
      return "refused.no_angles";
    case Refusal::kLate:
      return "refused.late";
    case Refusal::kDuplicate:
      return "refused.duplicate";
    case Refusal::kOtherDevice:
      return "refused.other_device";
    case Refusal::kDifopMode:
      return "refused.difop_mode";
    case Refusal::kDifopAngles:
      return "refused.difop_angles";
    case Refusal::kPosition:
      return "refused.position";
  }
  return "refused.unknown";
}

}  // namespace curbstone::lidar::decoding
