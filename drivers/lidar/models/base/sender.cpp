#include "drivers/lidar/models/base/sender.hpp"

#include <algorithm>
#include <cstddef>

#include "common/bytes/big_endian.hpp"
#include "drivers/lidar/models/base/other_makers.hpp"
#include "drivers/lidar/models/robosense/magic.hpp"

namespace curbstone::lidar::models {

namespace {

constexpr std::size_t kVelodyneSize = 1206;
constexpr std::size_t kVelodynePositionSize = 512;

template <class Magic>
bool begins_with(std::span<const std::uint8_t> bytes, const Magic& magic) {
  return bytes.size() >= magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin());
}

/// Older packets have the type in byte 30; newer ones a family in byte 31 and the model in byte 32. Source: RS-Helios
/// manuals, nebula 606ac41.
Sender helios_of(std::span<const std::uint8_t> bytes) {
  const int type = bytes[30];
  const int family = bytes[31];
  const int model = bytes[32];
  if (type == 0x06) return Sender::kHelios32;
  if (type == 0x07) return Sender::kHelios;
  if (family == 0x06 && model == 0x03) return Sender::kHelios16p;
  if (family == 0x06 && (model == 0x01 || model == 0x02 || model == 0x04)) return Sender::kHelios32;
  return Sender::kHelios;
}

/// A Helios has a table of elevations at 468, with a sign (0 or 1) and 0.01 deg each; an RS16 has no data there.
bool has_helios_angles(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kTable = 468;
  constexpr int kLasers = 16;
  int different = 0;
  int last = -1;
  for (int i = 0; i < kLasers; ++i) {
    const auto at = kTable + 3 * static_cast<std::size_t>(i);
    const int value = read_big_endian<std::uint16_t>(bytes.subspan(at + 1));
    if (bytes[at] > 1 || value > 9000) return false;
    const int signed_value = bytes[at] == 1 ? -value : value;
    if (signed_value != last) ++different;
    last = signed_value;
  }
  return different > kLasers / 2;
}

Sender robosense_of(std::span<const std::uint8_t> bytes) {
  if (begins_with(bytes, robosense::kMsopMagic)) return Sender::kRs16;
  if (begins_with(bytes, robosense::kHeliosMagic)) return Sender::kHelios;
  if (begins_with(bytes, robosense::kDifopMagic)) return Sender::kRs16Info;
  return Sender::kUnknown;
}

/// A marked block among those of another device is a damaged one: the devices with such blocks have several of them.
Sender velodyne_of(std::span<const std::uint8_t> bytes) {
  constexpr int kSeveral = 2;
  int lower_bank = 0, of_vls128 = 0;
  for (std::size_t block = 0; block < 12; ++block) {
    const int first = bytes[100 * block];
    const int second = bytes[100 * block + 1];
    const int mark = first == 0xFF ? second : second == 0xFF ? first : 0;
    if (mark == 0xDD)
      ++lower_bank;
    else if (mark == 0xCC || mark == 0xBB)
      ++of_vls128;
    else if (first != 0xFF || second != 0xEE)
      return Sender::kUnknown;
  }
  if (of_vls128 >= kSeveral) return Sender::kVls128;
  if (lower_bank >= kSeveral) return Sender::kHdl64e;
  if (lower_bank + of_vls128 > 0) return Sender::kUnknown;
  switch (bytes[1205]) {
    case 0x22:
      return Sender::kVlp16;
    case 0x24:
      return Sender::kPuckHiRes;
    case 0x21:
      return Sender::kHdl32e;
    case 0x28:
      return Sender::kVlp32c;
    case 0x63:
    case 0xA1:
      return Sender::kVls128;
    default:
      return Sender::kVelodyne;
  }
}

/// Of the makers whose points the driver reads.
Sender known_sender_of(std::span<const std::uint8_t> bytes) {
  if (bytes.size() == kVelodyneSize) return velodyne_of(bytes);
  if (bytes.size() == kVelodynePositionSize) {
    // No magic; the first 198 bytes are unused and zero.
    return std::all_of(bytes.begin(), bytes.begin() + 198, [](std::uint8_t byte) { return byte == 0; })
               ? Sender::kVlp16Position
               : Sender::kUnknown;
  }
  if (bytes.size() != robosense::kPacketSize) {
    const bool robosense = bytes.size() > 100 && bytes[0] == 0x55 && bytes[1] == 0xAA && bytes[2] == 0x5A;
    return robosense ? Sender::kRoboSense : Sender::kUnknown;
  }
  const Sender sender = robosense_of(bytes);
  if (sender == Sender::kHelios) return helios_of(bytes);
  if (sender == Sender::kRs16Info && has_helios_angles(bytes)) return Sender::kHeliosInfo;
  return sender;
}

}  // namespace

Sender sender_of(std::span<const std::uint8_t> bytes) {
  const Sender sender = known_sender_of(bytes);
  return sender == Sender::kUnknown ? other_maker_of(bytes) : sender;
}

const char* counter_of(Sender sender) {
  switch (sender) {
    case Sender::kUnknown:
      return "refused.magic";
    case Sender::kRs16:
    case Sender::kRs16Info:
      return "refused.rs16";
    case Sender::kHelios:
    case Sender::kHeliosInfo:
      return "refused.helios";
    case Sender::kHelios16p:
      return "refused.helios16p";
    case Sender::kHelios32:
      return "refused.helios32";
    case Sender::kRoboSense:
      return "refused.robosense";
    case Sender::kVlp16:
    case Sender::kVlp16Position:
      return "refused.vlp16";
    case Sender::kPuckHiRes:
      return "refused.puck_hi_res";
    case Sender::kHdl32e:
      return "refused.hdl32e";
    case Sender::kVlp32c:
      return "refused.vlp32c";
    case Sender::kHdl64e:
      return "refused.hdl64e";
    case Sender::kVls128:
      return "refused.vls128";
    case Sender::kVelodyne:
      return "refused.velodyne";
    case Sender::kHesai:
      return "refused.hesai";
    case Sender::kLivox:
      return "refused.livox";
    case Sender::kOuster:
      return "refused.ouster";
  }
  return "refused.magic";
}

const char* title_of(Sender sender) {
  switch (sender) {
    case Sender::kUnknown:
      return "an unknown device";
    case Sender::kRs16:
    case Sender::kRs16Info:
      return "a RoboSense RS-LiDAR-16";
    case Sender::kHelios:
    case Sender::kHeliosInfo:
      return "a RoboSense Helios";
    case Sender::kHelios16p:
      return "a RoboSense Helios 16P";
    case Sender::kHelios32:
      return "a RoboSense Helios with 32 lasers";
    case Sender::kRoboSense:
      return "another RoboSense LiDAR";
    case Sender::kVlp16:
    case Sender::kVlp16Position:
      return "a Velodyne VLP-16";
    case Sender::kPuckHiRes:
      return "a Velodyne Puck Hi-Res";
    case Sender::kHdl32e:
      return "a Velodyne HDL-32E";
    case Sender::kVlp32c:
      return "a Velodyne VLP-32C";
    case Sender::kHdl64e:
      return "a Velodyne HDL-64E";
    case Sender::kVls128:
      return "a Velodyne VLS-128";
    case Sender::kVelodyne:
      return "another Velodyne LiDAR";
    case Sender::kHesai:
      return "a Hesai LiDAR";
    case Sender::kLivox:
      return "a Livox LiDAR";
    case Sender::kOuster:
      return "an Ouster LiDAR";
  }
  return "an unknown device";
}

}  // namespace curbstone::lidar::models
