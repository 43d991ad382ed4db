#pragma once

#include <cstdint>
#include <span>

namespace curbstone::lidar::models {

/// Which device a packet comes from and what it holds, by its bytes alone: ports do not tell makers apart.
enum class Sender {
  kUnknown,        ///< none of these, or damaged beyond recognition
  kRs16,           ///< point packets of an RS-LiDAR-16. RS32 and RS-Bpearl packets look the same
  kRs16Info,       ///< device information of those
  kHelios,         ///< point packets of an RS-Helios of 16 or 32 lasers: its type byte is shared
  kHelios16p,      ///< the same, of 16
  kHelios32,       ///< the same, of 32
  kHeliosInfo,     ///< device information of any Helios
  kRoboSense,      ///< point packets of another RoboSense
  kVlp16,          ///< point packets of a Velodyne VLP-16 or Puck LITE
  kVlp16Position,  ///< 512 bytes with the state of its PPS and the GPS's text
  kPuckHiRes,      ///< point packets of the other Velodynes, which have the same length
  kHdl32e,
  kVlp32c,
  kHdl64e,
  kVls128,
  kVelodyne,  ///< one more of them
};

[[nodiscard]] Sender sender_of(std::span<const std::uint8_t> bytes);

/// The counter of packets that the chosen model has no use for: "refused.vlp16".
[[nodiscard]] const char* counter_of(Sender sender);
/// "a Velodyne VLP-16".
[[nodiscard]] const char* title_of(Sender sender);

}  // namespace curbstone::lidar::models
