#pragma once

#include <cstdint>
#include <span>

namespace curbstone::lidar::models {

/// The device and kind of a packet, by its bytes alone: ports do not distinguish makers.
enum class Sender {
  kUnknown,        ///< none of these, or damaged
  kRs16,           ///< point packets of an RS-LiDAR-16. RS32 and RS-Bpearl packets look the same
  kRs16Info,       ///< device information of these
  kHelios,         ///< point packets of an RS-Helios with 16 or 32 lasers: they share the type byte
  kHelios16p,      ///< the same, with 16
  kHelios32,       ///< the same, with 32
  kHeliosInfo,     ///< device information of any Helios
  kRoboSense,      ///< point packets of another RoboSense LiDAR
  kVlp16,          ///< point packets of a Velodyne VLP-16 or Puck LITE
  kVlp16Position,  ///< 512 bytes with the state of its PPS and the GPS's sentence
  kPuckHiRes,      ///< point packets of the other Velodynes, which have the same length
  kHdl32e,
  kVlp32c,
  kHdl64e,
  kVls128,
  kVelodyne,  ///< any other Velodyne
  kHesai,     ///< of these makers, whatever model and kind
  kLivox,
  kOuster,
};

[[nodiscard]] Sender sender_of(std::span<const std::uint8_t> bytes);

/// Whether it sent device information, not points.
[[nodiscard]] constexpr bool is_info(Sender sender) {
  return sender == Sender::kRs16Info || sender == Sender::kHeliosInfo || sender == Sender::kVlp16Position;
}

/// Whether it sent something that a model of this driver reads. Others are named, but never chosen.
[[nodiscard]] constexpr bool is_supported(Sender sender) {
  switch (sender) {
    case Sender::kRs16:
    case Sender::kHelios:
    case Sender::kHelios16p:
    case Sender::kHelios32:
    case Sender::kVlp16:
      return true;
    default:
      return is_info(sender);
  }
}

/// Counter of packets that are not for the chosen model: "refused.vlp16".
[[nodiscard]] const char* counter_of(Sender sender);
/// "a Velodyne VLP-16".
[[nodiscard]] const char* title_of(Sender sender);

}  // namespace curbstone::lidar::models
