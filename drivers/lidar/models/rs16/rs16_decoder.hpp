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

/// Decodes RS-LiDAR-16 point packets (MSOP, one or two returns per shot) to points. One thread. Source: RS-LiDAR-16
/// user manual, appendix A; rs_driver 4eeadace.
///
/// Two returns: a block is one firing sequence, its first 16 records are one return of each shot, its last 16 the
/// other. If a shot has only one return, both are equal, and it is published once.
class Rs16Decoder {
 public:
  explicit Rs16Decoder(const decoding::ReturnLimits& limits);

  /// Sets the reported device information; nominal until then.
  void set_device(const DeviceInfo& device);
  [[nodiscard]] const DeviceInfo& device() const { return device_; }

  /// Overwrites `packet`, whose vectors keep their memory. Any bytes are allowed; `packet` is undefined if refused.
  [[nodiscard]] decoding::Refusal decode(std::span<const std::uint8_t> bytes, decoding::DecodedPacket& packet);

 private:
  decoding::ReturnLimits limits_;
  DeviceInfo device_;
  decoding::BlindZone blind_zone_;
  double block_period_ = kBlockPeriod;  ///< s
  std::shared_ptr<const decoding::PointRules> rules_;
};

}  // namespace curbstone::lidar::models::rs16
