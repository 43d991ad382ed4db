#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "drivers/lidar/decoding/blind_zone.hpp"
#include "drivers/lidar/decoding/decoded_packet.hpp"
#include "drivers/lidar/decoding/point_writer.hpp"
#include "drivers/lidar/decoding/refusal.hpp"
#include "drivers/lidar/models/rs16/device_info.hpp"

namespace curbstone::lidar::models::rs16 {

/// RS-LiDAR-16 point packets (MSOP, one or two returns a shot) to points. One thread. Source: RS-LiDAR-16 user manual,
/// appendix A; rs_driver 4eeadace.
///
/// Two returns: a block is one firing sequence, its first 16 records one return of each shot, its last 16 the other.
/// Where a shot has but one, both are the same, and it goes out once.
class Rs16Decoder {
 public:
  explicit Rs16Decoder(const decoding::ReturnLimits& limits);

  /// What the device says about itself; nominal until then.
  void set_device(const DeviceInfo& device);
  [[nodiscard]] const DeviceInfo& device() const { return device_; }

  /// Overwrites `packet`, whose vectors keep their memory. Any bytes may come; `packet` means nothing when refused.
  [[nodiscard]] decoding::Refusal decode(std::span<const std::uint8_t> bytes, decoding::DecodedPacket& packet);

 private:
  decoding::ReturnLimits limits_;
  DeviceInfo device_;
  decoding::BlindZone blind_zone_;
  double block_period_ = kBlockPeriod;  ///< s
  std::shared_ptr<const decoding::PointRules> rules_;
};

}  // namespace curbstone::lidar::models::rs16
