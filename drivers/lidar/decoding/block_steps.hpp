#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "drivers/lidar/decoding/blind_zone.hpp"

namespace curbstone::lidar::decoding {

/// The head's rotation within one data block, and the block's start time.
struct BlockSpan {
  double angle = 0;  ///< in the unit of the azimuths
  double start = 0;  ///< in the unit of the block period, after the packet's first shot
};

/// The head's rotation during a packet.
struct BlockSteps {
  bool steady = false;     ///< all steps fit a rotating head, except one at the blind zone
  double mean = 0;         ///< 0.01 deg per block, without the blind zone
  std::optional<Gap> gap;  ///< the one step that does not fit, if it leads forward
};

/// Computes the rotation within each block of a packet. A packet contains only the azimuth of each block's first shot
/// (0.01 deg, 0..35999). The head turns within a block by the step to the next block's azimuth; within the last block,
/// by the mean step. A head is heavy: within a packet (1.3 ms) its steps are equal except for rounding and jitter. A
/// step that differs is the blind zone; otherwise an azimuth is damaged and the packet must not be used (`steady` is
/// false). The block before a blind zone turns by the mean, and the gap gives the time to pass the zone. Packets of a
/// head that stands are not used either. Source: rs_driver 4eeadace, Rs16SingleReturnBlockIterator, which takes any
/// step of more than 1 deg for a blind zone.
///
/// `spans` has as many elements as `azimuths`, at most kMaxBlocks. `block_period` in any unit of time.
inline constexpr std::size_t kMaxBlocks = 12;
[[nodiscard]] BlockSteps block_steps(std::span<const std::uint16_t> azimuths, const BlindZone& blind_zone,
                                     double block_period, std::span<BlockSpan> spans);

/// Reports a packet without steady steps to the blind zone: the next stamp will show whether its gap is one. `stamp`:
/// us, if it is valid; `blocks`: number of azimuths of the packet; `block_period`: s.
void suspect_blind_zone(const BlockSteps& steps, std::optional<std::int64_t> stamp, std::size_t blocks,
                        double block_period, BlindZone& blind_zone);

}  // namespace curbstone::lidar::decoding
