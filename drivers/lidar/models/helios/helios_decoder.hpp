#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "drivers/lidar/decoding/blind_zone.hpp"
#include "drivers/lidar/decoding/decoded_packet.hpp"
#include "drivers/lidar/decoding/point_writer.hpp"
#include "drivers/lidar/decoding/refusal.hpp"
#include "drivers/lidar/models/helios/device_info.hpp"
#include "drivers/lidar/models/helios/helios.hpp"
#include "drivers/lidar/models/helios/msop_packet.hpp"

namespace curbstone::lidar::models::helios {

/// Decodes point packets of a Helios to points, once its angles are known. One thread.
///
/// 16 lasers, one return: a block is two sequences. Two returns: a block is one sequence, its halves are the returns.
/// 32 lasers, one return: a block is one sequence. Two returns: the blocks come in pairs with the same azimuth. If a
/// shot has only one return, both are equal, and it is published once. Source: RS-Helios-16P user manual; nebula
/// 606ac41.
class HeliosDecoder {
 public:
  HeliosDecoder(const Variant& variant, const decoding::ReturnLimits& limits, std::optional<double> distance_step);

  void set_device(const DeviceInfo& device);
  [[nodiscard]] decoding::Refusal decode(std::span<const std::uint8_t> bytes, decoding::DecodedPacket& packet);

 private:
  /// How the blocks of a packet make firings: the blocks with the same azimuth, and the sequences in a block.
  struct Firings {
    std::size_t blocks;  ///< of a firing
    std::size_t count;   ///< in a packet
    double period;       ///< s
  };
  [[nodiscard]] Firings firings() const;
  [[nodiscard]] bool has_returns_in_halves() const { return dual_return_ && variant_.lasers == kRecords / 2; }
  [[nodiscard]] std::array<decoding::BlockRecords, 2> returns_of(std::span<const MsopBlock> blocks) const;
  [[nodiscard]] bool unit_is_credible(std::uint8_t unit);
  /// `distance_step`: m.
  [[nodiscard]] const std::shared_ptr<const decoding::PointRules>& rules_in(double distance_step);

  const Variant& variant_;
  std::optional<double> distance_step_;  ///< m, set by the user
  decoding::BlindZone blind_zone_;
  bool dual_return_ = false;
  decoding::PointRules next_rules_;                    ///< except for the distance unit
  std::shared_ptr<const decoding::PointRules> rules_;  ///< of the latest packet; null: next_rules_ is new
  std::optional<std::uint8_t> unit_;
  int other_units_ = 0;  ///< consecutive packets with another unit
};

}  // namespace curbstone::lidar::models::helios
