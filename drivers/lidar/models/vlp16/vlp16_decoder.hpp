#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "drivers/lidar/decoding/blind_zone.hpp"
#include "drivers/lidar/decoding/decoded_packet.hpp"
#include "drivers/lidar/decoding/point_writer.hpp"
#include "drivers/lidar/decoding/refusal.hpp"
#include "drivers/lidar/models/base/model.hpp"
#include "drivers/lidar/models/vlp16/vlp16_packet.hpp"

namespace curbstone::lidar::models::vlp16 {

/// VLP-16 data packets (strongest, last or dual return) to points. One thread. Source: VLP-16 User Manual, chapter 9;
/// nebula 606ac41.
///
/// A packet's stamp is past the hour, without a date. The first one is taken to the hour that brings it nearest to its
/// time of receipt, the next ones to where they go on from there.
///
/// Dual: the blocks come in pairs of one azimuth and one time, first the last return, then the strongest, or the second
/// strongest where the strongest is the last. Where a shot has but one, both are the same, and it goes out once.
class Vlp16Decoder {
 public:
  /// `angles`: the user's, or none.
  Vlp16Decoder(const decoding::ReturnLimits& limits, const std::vector<LaserAngles>& angles);

  /// Overwrites `packet`, whose vectors keep their memory. Any bytes may come. `received`: us since the Unix epoch.
  [[nodiscard]] decoding::Refusal decode(std::int64_t received, std::span<const std::uint8_t> bytes,
                                         decoding::DecodedPacket& packet);

  [[nodiscard]] bool dual_return() const { return dual_return_; }

 private:
  [[nodiscard]] std::int64_t resolve(std::int64_t past_hour, std::int64_t received);

  decoding::BlindZone blind_zone_;
  std::shared_ptr<const decoding::PointRules> rules_;
  bool dual_return_ = false;
  std::optional<std::int64_t> last_stamp_;
  std::int64_t last_received_ = 0;
};

}  // namespace curbstone::lidar::models::vlp16
