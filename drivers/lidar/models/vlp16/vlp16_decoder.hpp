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

/// Decodes VLP-16 data packets (strongest, last or dual return) to points. One thread. Source: VLP-16 User Manual,
/// chapter 9; nebula 606ac41.
///
/// A packet's stamp is the time past the hour, without a date. The first one gets the hour that is nearest to its time
/// of receipt, the next ones the hour that continues from there.
///
/// Dual return: the blocks come in pairs with the same azimuth and time, first the last return, then the strongest, or
/// the second strongest if the strongest is the last. If a shot has only one return, both are equal, and it is
/// published once.
class Vlp16Decoder {
 public:
  /// `angles`: the user's; may be empty.
  Vlp16Decoder(const decoding::ReturnLimits& limits, const std::vector<LaserAngles>& angles);

  /// Overwrites `packet`, whose vectors keep their memory. Any bytes are allowed. `received`: us since the Unix epoch.
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
