#pragma once

#include <cstdint>
#include <span>

namespace curbstone {

/// How far the head turns within one data block, and when the block begins.
struct BlockSpan {
  double angle = 0;  ///< in the unit of the azimuths
  double start = 0;  ///< in the unit of the block period, after the packet's first shot
};

/// A packet gives the azimuth of each block's first shot only (0.01 deg, 0..35999). The turn within a block is the
/// step to the next one's; the last block turns as far as `nominal`. A step of more than 1 deg is a blind zone, which
/// the head passes without firing: the block before it turns as far as `nominal`, and the time it takes follows from
/// the gap. Source: rs_driver 4eeadace, Rs16SingleReturnBlockIterator (which takes the blind zone's width from DIFOP).
///
/// `spans` has as many elements as `azimuths`. A small step back (jitter of a standing head) stays one.
void block_spans(std::span<const std::uint16_t> azimuths, double nominal, double block_period,
                 std::span<BlockSpan> spans);

/// The mean step of a packet without its blind zones, 0.01 deg: the best `nominal`. Negative or 0 when the head stands.
/// `otherwise` when there is no step to take a mean of.
[[nodiscard]] double mean_block_step(std::span<const std::uint16_t> azimuths, double otherwise);

}  // namespace curbstone
